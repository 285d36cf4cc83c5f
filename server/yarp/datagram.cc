// SPDX-License-Identifier: MIT
#include "server/yarp/datagram.h"

#include <algorithm>
#include <boost/crc.hpp>
#include <optional>
#include <utility>

#include "server/yarp/carrier.h"
#include "server/yarp/yarp_bytes.h"

namespace coopdyn {
namespace {

constexpr std::size_t kHeadBytes = 8;
constexpr std::int32_t kWakeUp = -1;  // a datagram to be ignored

std::uint32_t ChecksumOf(std::string_view bytes) {
  boost::crc_32_type crc;
  crc.process_bytes(bytes.data(), bytes.size());
  return crc.checksum();
}

}  // namespace

std::vector<std::string> CutIntoDatagrams(std::string_view message) {
  constexpr std::size_t kPiece = kMaxDatagramBytes - kHeadBytes;
  std::vector<std::string> datagrams;
  for (std::size_t at = 0; at < message.size(); at += kPiece) {
    const std::string_view piece = message.substr(at, kPiece);
    std::string datagram;
    AppendBytes(ChecksumOf(piece), datagram);
    AppendBytes(static_cast<std::int32_t>(datagrams.size()), datagram);
    datagrams.push_back(datagram.append(piece));
  }
  return datagrams;
}

void DatagramJoiner::Drop() {
  pieces_.clear();
  next_ = 0;
}

std::string DatagramJoiner::Add(std::string_view datagram) {
  ByteScanner scanner(datagram);
  const auto checksum = scanner.Take<std::uint32_t>();
  const auto number = scanner.Take<std::int32_t>();
  if (!number || *number == kWakeUp) return {};
  if (*number == 0) Drop();
  if (*number != next_ || *checksum != ChecksumOf(scanner.rest())) {
    Drop();
    return {};
  }
  pieces_.append(scanner.rest());
  ++next_;
  YarpReader reader;
  reader.Next(YarpHello(YarpCarrier::kFastTcp, ""));
  std::size_t whole = 0;
  while (whole < pieces_.size()) {
    const YarpInput input = reader.Next(std::string_view(pieces_).substr(whole));
    if (input.kind == YarpInput::Kind::kBroken) Drop();
    if (input.kind != YarpInput::Kind::kCommand) break;
    whole += input.consumed;
  }
  if (whole == 0 || whole < pieces_.size()) return {};
  std::string messages = std::move(pieces_);
  Drop();
  return messages;
}

}  // namespace coopdyn
