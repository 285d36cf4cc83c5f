// SPDX-License-Identifier: MIT
// The binary codec: any bytes consume, need more or end; a decoded message encodes to the same bytes; a
// prefix never decides differently than the whole.

// link: coopdyn_protocol

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "protocol/codec.h"

namespace {

void Require(bool condition) {
  if (!condition) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using coopdyn::DecodeStatus;
  std::string_view bytes(reinterpret_cast<const char*>(data), size);
  (void)coopdyn::SniffEncoding(bytes);
  while (true) {
    const coopdyn::Decoded decoded = coopdyn::DecodeBinary(bytes);
    if (decoded.status == DecodeStatus::kNeedMore) {
      Require(decoded.consumed == 0);
      return 0;
    }
    Require(coopdyn::IsCleanUtf8(decoded.message.text));
    if (decoded.status == DecodeStatus::kFatal) return 0;
    Require(decoded.consumed >= 24 && decoded.consumed <= bytes.size());
    if (decoded.status == DecodeStatus::kMessage) {
      std::string again;
      coopdyn::EncodeBinary(decoded.message, again);
      Require(again == bytes.substr(0, decoded.consumed));
    } else {
      Require(decoded.status == DecodeStatus::kBad && decoded.message.error == 7);
    }
    const coopdyn::Decoded early = coopdyn::DecodeBinary(bytes.substr(0, decoded.consumed - 1));
    Require(early.status == DecodeStatus::kNeedMore);
    bytes.remove_prefix(decoded.consumed);
  }
}
