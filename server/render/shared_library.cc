// SPDX-License-Identifier: MIT
#include "server/render/shared_library.h"

#include <dlfcn.h>

namespace coopdyn {

SharedLibrary SharedLibrary::Open(std::initializer_list<const char*> names, std::string& error) {
  SharedLibrary library;
  for (const char* name : names) {
    library.handle_ = dlopen(name, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
    if (library.handle_) break;
    if (error.empty()) error = dlerror();
  }
  return library;
}

void* SharedLibrary::Find(const char* name) const {
  return dlsym(handle_, name);
}

}  // namespace coopdyn
