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

// The runtime takes a thread's block of a loaded library's thread-local variables for one of glibc
// before 2.25 when malloc put it 16 bytes into a page, and then the search for leaks reads what lies before
// it as an address: "Tracer caught signal 11" at the end of a program that was all right (mended in GCC 14
// and LLVM 17, google/sanitizers#1322).
extern "C" const char* __asan_default_options();
extern "C" const char* __asan_default_options() {
  return "intercept_tls_get_addr=0";
}
