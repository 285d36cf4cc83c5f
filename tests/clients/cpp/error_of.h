// SPDX-License-Identifier: MIT
// The error that a call of the client is expected to throw.
#pragma once

#include <functional>
#include <string>

#include "clients/cpp/coopdyn_client.h"

namespace coopdyn::client {

/// The error of a call; code 0 if it throws none.
inline Error ErrorOf(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& e) {
    return e;
  }
  return Error(0, "no error");
}

/// Whether "CODE TEXT" of the error contains the words.
inline bool Says(const Error& error, const std::string& words) {
  return (std::to_string(error.code()) + " " + error.text()).find(words) != std::string::npos;
}

}  // namespace coopdyn::client
