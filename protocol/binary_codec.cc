// SPDX-License-Identifier: MIT
#include <algorithm>
#include <bit>
#include <cstring>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "protocol/ascii.h"
#include "protocol/codec.h"
#include "protocol/command_ids.h"

namespace coopdyn {
namespace {

constexpr std::size_t kSizeBytes = 4;
constexpr std::size_t kHeaderBytes = 20;  // error, command, T, M, N
constexpr std::size_t kCommandEnd = 12;   // bytes of a frame up to and including the command

template <typename T>
T ReadLittle(const char* bytes) {
  std::make_unsigned_t<T> value = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    value |= static_cast<std::make_unsigned_t<T>>(static_cast<unsigned char>(bytes[i])) << (8 * i);
  }
  return static_cast<T>(value);
}

template <typename T>
void WriteLittle(T value, char*& to) {
  const auto bits = static_cast<std::make_unsigned_t<T>>(value);
  for (std::size_t i = 0; i < sizeof(T); ++i) *to++ = static_cast<char>((bits >> (8 * i)) & 0xFF);
}

template <typename T>
using BitsOf = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;

/// Fills `values`. Readings of whole teams pass here, so little-endian machines copy them in one go.
template <typename T>
void ReadAll(const char*& from, std::vector<T>& values) {
  if constexpr (std::endian::native == std::endian::little) {
    if (!values.empty()) std::memcpy(values.data(), from, values.size() * sizeof(T));
    from += values.size() * sizeof(T);
  } else {
    for (T& value : values) {
      value = std::bit_cast<T>(ReadLittle<BitsOf<T>>(from));
      from += sizeof(T);
    }
  }
}

template <typename T>
void WriteAll(const std::vector<T>& values, char*& to) {
  if constexpr (std::endian::native == std::endian::little) {
    if (!values.empty()) std::memcpy(to, values.data(), values.size() * sizeof(T));
    to += values.size() * sizeof(T);
  } else {
    for (const T value : values) WriteLittle(std::bit_cast<BitsOf<T>>(value), to);
  }
}

Decoded Fatal(Error error, std::string text) {
  return {DecodeStatus::kFatal, 0, ErrorReply(command::kUnreadable, error, std::move(text))};
}

Decoded TooLarge(std::uint64_t size, std::uint64_t limit) {
  return Fatal(Error::kTooLarge, "a message of " + std::to_string(size) + " bytes is too large: at most " +
                                     std::to_string(limit) + " bytes");
}

}  // namespace

Decoded DecodeBinary(std::string_view bytes, std::size_t max_bytes) {
  if (bytes.size() < kSizeBytes) return {};
  const auto size = ReadLittle<std::uint32_t>(bytes.data());
  if (size < kHeaderBytes) {
    return Fatal(Error::kMalformed,
                 "size " + std::to_string(size) +
                     " is too small: it counts the bytes that follow it, 20 + T + 4M + 8N");
  }
  const std::size_t texts_limit = std::max(max_bytes, kMaxTextsBytes);
  if (size > texts_limit) return TooLarge(size, texts_limit);
  if (size > max_bytes) {
    if (bytes.size() < kCommandEnd) return {};
    if (ReadLittle<std::int32_t>(bytes.data() + 8) != command::kLoadScenario)
      return TooLarge(size, max_bytes);
  }
  if (bytes.size() < kSizeBytes + kHeaderBytes) return {};
  const char* header = bytes.data() + kSizeBytes;
  const std::uint64_t text_bytes = ReadLittle<std::uint32_t>(header + 8);
  const std::uint64_t params = ReadLittle<std::uint32_t>(header + 12);
  const std::uint64_t data = ReadLittle<std::uint32_t>(header + 16);
  if (kHeaderBytes + text_bytes + 4 * params + 8 * data != size) {
    return Fatal(Error::kMalformed, "the counts do not add up: size " + std::to_string(size) +
                                        " must be 20 + T + 4M + 8N, with T " + std::to_string(text_bytes) +
                                        ", M " + std::to_string(params) + ", N " + std::to_string(data));
  }
  if (bytes.size() < kSizeBytes + size) return {};

  Decoded decoded{DecodeStatus::kMessage, kSizeBytes + size, {}};
  Message& message = decoded.message;
  message.error = ReadLittle<std::int32_t>(header);
  message.command = ReadLittle<std::int32_t>(header + 4);
  const char* from = header + kHeaderBytes;
  const std::string_view text(from, text_bytes);
  if (!IsCleanUtf8(text)) {
    decoded.status = DecodeStatus::kBad;
    message = ErrorReply(message.command, Error::kMalformed, "the text must be UTF-8 without NUL");
    return decoded;
  }
  message.text = text;
  from += text_bytes;
  message.params.resize(params);
  ReadAll(from, message.params);
  message.data.resize(data);
  ReadAll(from, message.data);
  return decoded;
}

void EncodeBinary(const Message& message, std::string& out) {
  const std::size_t size =
      kHeaderBytes + message.text.size() + 4 * message.params.size() + 8 * message.data.size();
  const std::size_t start = out.size();
  out.resize(start + kSizeBytes + size);
  char* to = out.data() + start;
  WriteLittle(static_cast<std::uint32_t>(size), to);
  WriteLittle(message.error, to);
  WriteLittle(message.command, to);
  WriteLittle(static_cast<std::uint32_t>(message.text.size()), to);
  WriteLittle(static_cast<std::uint32_t>(message.params.size()), to);
  WriteLittle(static_cast<std::uint32_t>(message.data.size()), to);
  to = std::copy(message.text.begin(), message.text.end(), to);
  WriteAll(message.params, to);
  WriteAll(message.data, to);
}

FirstBytes SniffEncoding(std::string_view bytes) {
  constexpr std::string_view kFamily = "CDS";
  constexpr std::size_t kMaxMethodBytes = 32;
  if (bytes.starts_with(kBinaryMagic)) return FirstBytes::kBinary;
  if (kFamily.starts_with(bytes) || bytes == kFamily) return FirstBytes::kUndecided;
  if (bytes.starts_with(kFamily)) return FirstBytes::kWrongMagic;

  // The protocol's words are lower-case, so METHOD SP suggests an HTTP request. The whole first line decides,
  // because the name server's `OPEN /robot1/motors` looks like one, too.
  const auto letters =
      static_cast<std::size_t>(std::find_if_not(bytes.begin(), bytes.end(), IsUpper) - bytes.begin());
  if (letters == 0 || letters > kMaxMethodBytes) return FirstBytes::kText;
  if (letters == bytes.size()) return FirstBytes::kUndecided;
  if (bytes[letters] != ' ') return FirstBytes::kText;
  const std::string_view seen = bytes.substr(0, kMaxSniffBytes);
  const std::string_view line = seen.substr(0, seen.find('\n'));
  // YARP's mjpeg sends a request line without HTTP/.
  if (line.starts_with("GET /") || line.find("HTTP/") != std::string_view::npos) return FirstBytes::kHttp;
  if (line.size() < seen.size()) return FirstBytes::kText;
  return bytes.size() < kMaxSniffBytes ? FirstBytes::kUndecided : FirstBytes::kHttp;
}

}  // namespace coopdyn
