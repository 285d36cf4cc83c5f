// SPDX-License-Identifier: MIT
#include "vectors.h"
#include "tests/source_dir.h"

#include <algorithm>
#include <bit>
#include <boost/json.hpp>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <stdexcept>

namespace coopdyn {
namespace {

namespace json = boost::json;

json::array ReadVectors(const std::string& name) {
  return json::parse(ReadWholeFile(SourceDir() + "/tests/protocol/vectors/" + name)).as_array();
}

std::string Text(const json::object& row, const char* key) {
  return json::value_to<std::string>(row.at(key));
}

template <typename T>
T Number(const json::object& row, const char* key) {
  return row.at(key).to_number<T>();
}

std::string Bytes(const json::object& row, const char* key) {
  const std::string hex = Text(row, key);
  std::string bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2) {
    bytes += static_cast<char>(std::stoi(hex.substr(i, 2), nullptr, 16));
  }
  return bytes;
}

Message ToMessage(const json::object& row) {
  Message message{.error = Number<std::int32_t>(row, "error"),
                  .text = Text(row, "text"),
                  .command = Number<std::int32_t>(row, "command"),
                  .params = {},
                  .data = {}};
  for (const json::value& param : row.at("params").as_array()) {
    message.params.push_back(param.to_number<std::int32_t>());
  }
  for (const json::value& value : row.at("data").as_array()) {
    message.data.push_back(std::strtod(json::value_to<std::string>(value).c_str(), nullptr));
  }
  return message;
}

}  // namespace

std::string ReadWholeFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error("cannot read " + path);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<MessageVector> MessageVectors() {
  std::vector<MessageVector> vectors;
  for (const json::value& value : ReadVectors("messages.json")) {
    const json::object& row = value.as_object();
    vectors.push_back({Text(row, "name"), ToMessage(row), Bytes(row, "binary_hex"), Text(row, "text_line")});
  }
  return vectors;
}

std::vector<BadBinaryVector> BadBinaryVectors() {
  std::vector<BadBinaryVector> vectors;
  for (const json::value& value : ReadVectors("bad_binary.json")) {
    const json::object& row = value.as_object();
    vectors.push_back({Text(row, "name"), Bytes(row, "hex"), Number<std::int32_t>(row, "error"),
                       Number<std::int32_t>(row, "command"), row.at("fatal").as_bool(),
                       Number<std::size_t>(row, "needs")});
  }
  return vectors;
}

std::vector<TextLineVector> TextLineVectors() {
  static const std::map<std::string, DecodeStatus> kOutcomes = {
      {"message", DecodeStatus::kMessage}, {"bad", DecodeStatus::kBad},   {"fatal", DecodeStatus::kFatal},
      {"nothing", DecodeStatus::kNothing}, {"help", DecodeStatus::kHelp}, {"verbose", DecodeStatus::kVerbose},
      {"leave", DecodeStatus::kLeave}};
  std::vector<TextLineVector> vectors;
  for (const json::value& value : ReadVectors("text_lines.json")) {
    const json::object& row = value.as_object();
    vectors.push_back({Text(row, "name"), Text(row, "module"), row.at("first_line").as_bool(),
                       Bytes(row, "line_hex"), kOutcomes.at(Text(row, "outcome")), ToMessage(row),
                       Text(row, "says")});
  }
  return vectors;
}

std::vector<FirstBytesVector> FirstBytesVectors() {
  static const std::map<std::string, FirstBytes> kEncodings = {{"undecided", FirstBytes::kUndecided},
                                                               {"binary", FirstBytes::kBinary},
                                                               {"wrong_magic", FirstBytes::kWrongMagic},
                                                               {"http", FirstBytes::kHttp},
                                                               {"text", FirstBytes::kText}};
  std::vector<FirstBytesVector> vectors;
  for (const json::value& value : ReadVectors("first_bytes.json")) {
    const json::object& row = value.as_object();
    vectors.push_back({Text(row, "name"), Bytes(row, "hex"), kEncodings.at(Text(row, "encoding"))});
  }
  return vectors;
}

std::vector<DoubleVector> DoubleVectors() {
  std::vector<DoubleVector> vectors;
  for (const json::value& value : ReadVectors("doubles.json")) {
    const json::object& row = value.as_object();
    vectors.push_back({Bytes(row, "hex"), Text(row, "text")});
  }
  return vectors;
}

bool SameBits(const Message& a, const Message& b) {
  const auto same = [](double x, double y) {
    return (std::isnan(x) && std::isnan(y)) ||
           std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
  };
  return a.error == b.error && a.text == b.text && a.command == b.command && a.params == b.params &&
         std::equal(a.data.begin(), a.data.end(), b.data.begin(), b.data.end(), same);
}

}  // namespace coopdyn
