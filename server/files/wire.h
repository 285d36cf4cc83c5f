// SPDX-License-Identifier: MIT
// What is said between us and the program coopdyn-files, which reads the files that libraries of others
// understand. It is asked for one file at a time, asks for the files that this one names, and answers. Pure,
// but for SendMessage() and ReceiveMessage(); any thread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "server/base/bytes.h"
#include "server/files/mesh_parts.h"

namespace coopdyn {

inline constexpr int kMaxImageSide = 8192;    // of a file
inline constexpr int kMaxTextureSide = 1024;  // larger textures are made smaller
inline constexpr const char* kFilesProgram = "coopdyn-files";
inline constexpr int kNoMemoryExit = 109;  // of the program
inline constexpr std::uint64_t kMaxFileMessage = 512u << 20;

enum class FileTalk : std::uint8_t {
  kReadMesh,     // to the program: a MeshRequest
  kReadTexture,  // the bytes of a picture
  kReadHeights,  // likewise
  kNeedFile,     // from the program: the name of a file that the mesh names
  kNeedPicture,  // likewise, a texture
  kFile,         // to the program: the bytes
  kNoFile,       // why there are none
  kMesh,         // from the program: a MeshAnswer
  kTexture,      // an Image
  kHeights,      // Heights
  kFailed,       // why it cannot be read
};

struct FileMessage {
  FileTalk kind = FileTalk::kFailed;
  std::vector<std::byte> bytes;
};

struct MeshRequest {
  std::string name;  // of the file, by which others are found
  std::string bytes;
  std::array<double, 3> scale{1, 1, 1};
  std::string part;  // the only one that is wanted; empty: all
};

struct MeshAnswer {
  std::vector<std::string> warnings;
  MeshParts parts;
};

/// Heights from 0 to 65535, row by row, the uppermost first.
struct Heights {
  int width = 0, height = 0;
  std::vector<std::uint16_t> values;

  /// From 0 to 1, between the points: x and y from 0 to 1.
  double At(double x, double y) const;
};

/// The bytes of a message, and back; nothing for bad ones.
std::vector<std::byte> ToBytes(const std::string& text);
std::vector<std::byte> ToBytes(const MeshRequest& request);
std::vector<std::byte> ToBytes(const MeshAnswer& answer);
std::vector<std::byte> ToBytes(const Image& image);
std::vector<std::byte> ToBytes(const Heights& heights);
std::optional<MeshRequest> MeshRequestOf(std::span<const std::byte> bytes);
std::optional<MeshAnswer> MeshAnswerOf(std::span<const std::byte> bytes);
std::optional<Image> ImageOf(std::span<const std::byte> bytes);
std::optional<Heights> HeightsOf(std::span<const std::byte> bytes);
std::string FileTextOf(std::span<const std::byte> bytes);

/// Over a connected SOCK_STREAM socket. False, or nothing, if the other end is gone, says what is no message,
/// or is silent for `patience_s`.
bool SendMessage(int socket, FileTalk kind, std::span<const std::byte> bytes);
std::optional<FileMessage> ReceiveMessage(int socket, int patience_s);

}  // namespace coopdyn
