// SPDX-License-Identifier: MIT
#include "server/base/diagnostics.h"

#include <utility>

namespace coopdyn {

void Diagnostics::Error(SourceLine where, std::string text) {
  all_.push_back({Diagnostic::Level::kError, std::move(where), std::move(text)});
  ++errors_;
}

void Diagnostics::Warning(SourceLine where, std::string text) {
  all_.push_back({Diagnostic::Level::kWarning, std::move(where), std::move(text)});
}

void Diagnostics::Append(const Diagnostics& other) {
  all_.insert(all_.end(), other.all_.begin(), other.all_.end());
  errors_ += other.errors_;
}

std::string Diagnostics::ToString() const {
  std::string out;
  for (const Diagnostic& diagnostic : all_) out += coopdyn::ToString(diagnostic) + '\n';
  return out;
}

std::string ToString(const Diagnostic& diagnostic) {
  std::string out = diagnostic.where.file;
  if (diagnostic.where.line > 0) out += ':' + std::to_string(diagnostic.where.line);
  out += diagnostic.level == Diagnostic::Level::kError ? ": error: " : ": warning: ";
  return out + diagnostic.text;
}

}  // namespace coopdyn
