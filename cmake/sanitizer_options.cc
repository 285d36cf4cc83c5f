// SPDX-License-Identifier: MIT
// What sanitizers need not report: Mesa's own threads and what it keeps until the process ends; it is not
// instrumented.

extern "C" const char* __tsan_default_suppressions();
extern "C" const char* __tsan_default_suppressions() {
  return "race:libOSMesa.so\n"
         "race:libEGL_mesa.so\n"
         "race:swrast_dri.so\n"
         "race:libLLVM\n"
         "mutex:libOSMesa.so\n"
         "mutex:swrast_dri.so\n";
}

extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libOSMesa.so\n"
         "leak:libEGL\n"
         "leak:swrast_dri.so\n"
         "leak:libglapi.so\n"
         "leak:libLLVM\n";
}

// Which suppressions were used is of no interest, and tests compare what a program says.
extern "C" const char* __lsan_default_options();
extern "C" const char* __lsan_default_options() {
  return "print_suppressions=0";
}
