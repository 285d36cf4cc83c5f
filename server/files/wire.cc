// SPDX-License-Identifier: MIT
#include "server/files/wire.h"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <memory>

namespace coopdyn {

namespace {

constexpr std::size_t kHeadBytes = 9;  // the kind and the size of the content

void CodeRequest(auto& codec, auto& request) {
  codec.Text(request.name);
  codec.Text(request.bytes);
  codec.Finite(request.scale);
  codec.Text(request.part);
}

/// Width and height, both within [1, most].
void CodeSides(auto& codec, auto& picture, int most) {
  codec.Number(picture.width);
  codec.Number(picture.height);
  codec.Require(picture.width >= 1 && picture.width <= most && picture.height >= 1 && picture.height <= most);
}

std::size_t PointsOf(const auto& picture) {
  return static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height);
}

void CodeImage(auto& codec, auto& image) {
  CodeSides(codec, image, kMaxTextureSide);
  codec.List(image.rgb, 1, [&codec](auto& part) { codec.Number(part); });
  codec.Require(image.rgb.size() == 3 * PointsOf(image));
}

void CodeHeights(auto& codec, auto& heights) {
  CodeSides(codec, heights, kMaxImageSide);
  codec.List(heights.values, 2, [&codec](auto& value) { codec.Number(value); });
  codec.Require(heights.values.size() == PointsOf(heights));
}

void CodeTexts(auto& codec, auto& texts) {
  codec.List(texts, 4, [&codec](auto& text) { codec.Text(text); });
}

std::vector<std::byte> Written(auto code) {
  std::vector<std::byte> bytes;
  ByteWriter writer(bytes);
  code(writer);
  return bytes;
}

template <typename Thing>
std::optional<Thing> Read(std::span<const std::byte> bytes, auto code) {
  ByteReader reader(bytes);
  Thing thing;
  code(reader, thing);
  if (!reader.finished()) return std::nullopt;
  return thing;
}

/// Waits until bytes can be read.
bool AwaitBytes(int socket, int patience_s) {
  pollfd one{socket, POLLIN, 0};
  return TEMP_FAILURE_RETRY(poll(&one, 1, patience_s < 0 ? -1 : 1000 * patience_s)) == 1;
}

/// Fills `to`. @pre the other end sends at least this number of bytes
bool ReceiveAll(int socket, std::span<std::byte> to, int patience_s) {
  while (!to.empty()) {
    if (!AwaitBytes(socket, patience_s)) return false;
    const ssize_t got = TEMP_FAILURE_RETRY(recv(socket, to.data(), to.size(), 0));
    if (got <= 0) return false;
    to = to.subspan(static_cast<std::size_t>(got));
  }
  return true;
}

bool SendAll(int socket, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = TEMP_FAILURE_RETRY(send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL));
    if (sent < 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(sent));
  }
  return true;
}

}  // namespace

double Heights::At(double x, double y) const {
  const double u = x * (width - 1), v = y * (height - 1);
  const int i = std::clamp(static_cast<int>(u), 0, std::max(width - 2, 0));
  const int k = std::clamp(static_cast<int>(v), 0, std::max(height - 2, 0));
  const auto at = [this](int column, int row) -> double {
    const std::uint16_t value =
        values[static_cast<std::size_t>(std::min(row, height - 1)) * static_cast<std::size_t>(width) +
               static_cast<std::size_t>(std::min(column, width - 1))];
    return static_cast<float>(value) / 65535;
  };
  return std::lerp(std::lerp(at(i, k), at(i + 1, k), u - i), std::lerp(at(i, k + 1), at(i + 1, k + 1), u - i),
                   v - k);
}

std::vector<std::byte> ToBytes(const std::string& text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

std::string FileTextOf(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::vector<std::byte> ToBytes(const MeshRequest& request) {
  return Written([&](auto& codec) { CodeRequest(codec, request); });
}

std::optional<MeshRequest> MeshRequestOf(std::span<const std::byte> bytes) {
  return Read<MeshRequest>(bytes, [](auto& codec, auto& request) { CodeRequest(codec, request); });
}

std::vector<std::byte> ToBytes(const Image& image) {
  return Written([&](auto& codec) { CodeImage(codec, image); });
}

std::optional<Image> ImageOf(std::span<const std::byte> bytes) {
  return Read<Image>(bytes, [](auto& codec, auto& image) { CodeImage(codec, image); });
}

std::vector<std::byte> ToBytes(const Heights& heights) {
  return Written([&](auto& codec) { CodeHeights(codec, heights); });
}

std::optional<Heights> HeightsOf(std::span<const std::byte> bytes) {
  return Read<Heights>(bytes, [](auto& codec, auto& heights) { CodeHeights(codec, heights); });
}

std::vector<std::byte> ToBytes(const MeshAnswer& answer) {
  return Written([&](auto& codec) {
    MeshTextures textures;
    const std::string parts = MeshToBytes(answer.parts, textures);
    CodeTexts(codec, answer.warnings);
    codec.List(textures, 12, [&codec](const auto& texture) { CodeImage(codec, *texture); });
    codec.Text(parts);
  });
}

std::optional<MeshAnswer> MeshAnswerOf(std::span<const std::byte> bytes) {
  MeshTextures textures;
  std::string parts;
  auto answer = Read<MeshAnswer>(bytes, [&](auto& codec, auto& read) {
    CodeTexts(codec, read.warnings);
    codec.List(textures, 12, [&codec](auto& texture) {
      Image image;
      CodeImage(codec, image);
      texture = std::make_shared<const Image>(std::move(image));
    });
    codec.Text(parts);
  });
  auto read = answer ? MeshFromBytes(parts, textures) : std::nullopt;
  if (!read) return std::nullopt;
  answer->parts = std::move(*read);
  return answer;
}

bool SendMessage(int socket, FileTalk kind, std::span<const std::byte> bytes) {
  const std::vector<std::byte> head = Written([&](auto& codec) {
    codec.Word(kind, FileTalk::kFailed);
    codec.Low(bytes.size(), 8);
  });
  return SendAll(socket, head) && SendAll(socket, bytes);
}

std::optional<FileMessage> ReceiveMessage(int socket, int patience_s) {
  constexpr std::size_t kStep = 1u << 20;  // allocate as bytes arrive, not by the claimed size
  std::array<std::byte, kHeadBytes> head{};
  if (!ReceiveAll(socket, head, patience_s)) return std::nullopt;
  FileMessage message;
  ByteReader reader(head);
  reader.Word(message.kind, FileTalk::kFailed);
  const std::uint64_t size = reader.Low(8);
  if (!reader.ok() || size > kMaxFileMessage) return std::nullopt;
  while (message.bytes.size() < size) {
    const std::size_t at = message.bytes.size();
    message.bytes.resize(std::min<std::size_t>(size, at + kStep));
    if (!ReceiveAll(socket, std::span(message.bytes).subspan(at), patience_s)) return std::nullopt;
  }
  return message;
}

}  // namespace coopdyn
