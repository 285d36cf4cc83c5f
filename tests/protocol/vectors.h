// SPDX-License-Identifier: MIT
// Reads the golden vectors. Used by tests only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "protocol/codec.h"

namespace coopdyn {

struct MessageVector {
  std::string name;
  Message message;
  std::string binary;
  std::string text_line;  // without LF
};

struct BadBinaryVector {
  std::string name;
  std::string bytes;
  std::int32_t error = 0;
  std::int32_t command = 0;
  bool fatal = false;
  std::size_t needs = 0;  // number of bytes that suffice to decide
};

struct TextLineVector {
  std::string name;
  std::string module;
  bool first_line = false;
  std::string line;  // with LF
  DecodeStatus outcome = DecodeStatus::kNothing;
  Message message;
  std::string says;  // part of the error text
};

struct FirstBytesVector {
  std::string name;
  std::string bytes;
  FirstBytes encoding = FirstBytes::kUndecided;
};

struct DoubleVector {
  std::string bytes;  // little-endian
  std::string text;
};

std::vector<MessageVector> MessageVectors();
std::vector<BadBinaryVector> BadBinaryVectors();
std::vector<TextLineVector> TextLineVectors();
std::vector<FirstBytesVector> FirstBytesVectors();
std::vector<DoubleVector> DoubleVectors();

/// Equal, with nan equal to nan and 0 different from -0.
bool SameBits(const Message& a, const Message& b);

std::string ReadWholeFile(const std::string& path);

}  // namespace coopdyn
