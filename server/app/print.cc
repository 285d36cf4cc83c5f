// SPDX-License-Identifier: MIT
#include "server/app/print.h"

#include <cstdio>

namespace coopdyn {

namespace {

void Write(std::FILE* file, std::string_view text) {
  const std::string shown = PrintableLines(text);
  std::fwrite(shown.data(), 1, shown.size(), file);
  std::fflush(file);
}

}  // namespace

void PrintLines(std::string_view text) {
  Write(stdout, text);
}

void PrintErrorLines(std::string_view text) {
  Write(stderr, text);
}

}  // namespace coopdyn
