// SPDX-License-Identifier: MIT
// A library loaded at run time. Never unloaded: Mesa leaves thread-local data behind that outlives its
// contexts.
#pragma once

#include <initializer_list>
#include <string>

namespace coopdyn {

class SharedLibrary {
 public:
  /// Loads the first of `names` that exists; `error` says why none did.
  static SharedLibrary Open(std::initializer_list<const char*> names, std::string& error);

  explicit operator bool() const { return handle_ != nullptr; }
  /// Sets `function` to the symbol `name`; false if there is none.
  template <typename Function>
  bool Get(const char* name, Function& function) const {
    function = reinterpret_cast<Function>(Find(name));
    return function != nullptr;
  }

 private:
  void* Find(const char* name) const;

  void* handle_ = nullptr;
};

}  // namespace coopdyn
