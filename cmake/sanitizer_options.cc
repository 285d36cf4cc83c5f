// SPDX-License-Identifier: MIT
// Default options of the sanitizers. Suppresses reports about Mesa, which is not instrumented: its own
// threads, and memory that it keeps until the process ends.

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

// Do not print the used suppressions: tests compare the output of programs.
extern "C" const char* __lsan_default_options();
extern "C" const char* __lsan_default_options() {
  return "print_suppressions=0";
}

// If malloc puts a thread's block of a loaded library's thread-local variables 16 bytes into a page, the
// runtime mistakes it for a block of glibc before 2.25, and the leak search reads the bytes before it as an
// address: "Tracer caught signal 11" at the end of a correct program (fixed in GCC 14 and LLVM 17,
// google/sanitizers#1322).
extern "C" const char* __asan_default_options();
extern "C" const char* __asan_default_options() {
  return "intercept_tls_get_addr=0";
}
