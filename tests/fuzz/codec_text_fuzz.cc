// SPDX-License-Identifier: MIT
// The text codec with every module's table: a line consumes itself, errors are clean texts, a decoded message
// prints to a line that reads back the same.

// link: coopdyn_protocol

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include <boost/json/value.hpp>

#include "protocol/codec.h"
#include "protocol/json_text.h"
#include "protocol/module_tables.h"

namespace {

void Require(bool condition) {
  if (!condition) std::abort();
}

/// Control characters have no escape: those lines do not read back the same by design.
bool Printable(std::string_view text) {
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if ((byte < 0x20 && c != '\n' && c != '\r' && c != '\t') || byte == 0x7F) return false;
  }
  return true;
}

void CheckLine(std::string_view bytes, const coopdyn::CommandTable& table, const coopdyn::Decoded& decoded) {
  using coopdyn::DecodeStatus;
  const coopdyn::Message& message = decoded.message;
  Require(decoded.consumed == bytes.find('\n') + 1);
  Require(coopdyn::IsCleanUtf8(message.text));
  Require(decoded.status != DecodeStatus::kBad || (message.error != 0 && !message.text.empty()));
  if (decoded.status != DecodeStatus::kMessage) return;
  std::string line;
  coopdyn::EncodeText(message, line);
  const coopdyn::Decoded again = coopdyn::DecodeText(line, table, false);
  Require(again.status == DecodeStatus::kMessage && again.consumed == line.size());
  Require(!Printable(message.text) || again.message.text == message.text);
  Require(again.message.params == message.params && again.message.data.size() == message.data.size());
  std::string second;
  coopdyn::EncodeText(again.message, second);
  Require(second == line);
  std::string verbose;
  coopdyn::EncodeVerbose(message, table, verbose);
  coopdyn::JsonText(boost::json::string(message.text));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::vector<coopdyn::CommandTable> tables = coopdyn::AllModuleTables();
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  for (const coopdyn::CommandTable& table : tables) {
    std::string_view rest = bytes;
    bool first_line = true;
    while (true) {
      const coopdyn::Decoded decoded = coopdyn::DecodeText(rest, table, first_line);
      if (decoded.status == coopdyn::DecodeStatus::kNeedMore ||
          decoded.status == coopdyn::DecodeStatus::kFatal)
        break;
      CheckLine(rest, table, decoded);
      rest.remove_prefix(decoded.consumed);
      first_line = false;
    }
  }
  return 0;
}
