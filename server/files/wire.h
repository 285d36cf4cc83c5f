// SPDX-License-Identifier: MIT
// The protocol between coopdyn and the program coopdyn-files, which reads files with third-party libraries.
// The program receives a request for one file, asks for the files that this file refers to, and answers. Pure
// except for SendMessage() and ReceiveMessage(); any thread.
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

inline constexpr int kMaxImageSide = 8192;    // in a file
inline constexpr int kMaxTextureSide = 1024;  // larger textures are scaled down
inline constexpr const char* kFilesProgram = "coopdyn-files";
inline constexpr int kNoMemoryExit = 109;  // the program's exit status when out of memory
inline constexpr std::uint64_t kMaxFileMessage = 512u << 20;

enum class FileTalk : std::uint8_t {
  kReadMesh,     // to the program: a MeshRequest
  kReadTexture,  // to the program: a picture's bytes
  kReadHeights,  // to the program: a picture's bytes
  kNeedFile,     // from the program: the name of a file that the mesh refers to
  kNeedPicture,  // from the program: the name of a texture that the mesh refers to
  kFile,         // to the program: the file's bytes
  kNoFile,       // to the program: why the file is unavailable
  kMesh,         // from the program: a MeshAnswer
  kTexture,      // from the program: an Image
  kHeights,      // from the program: Heights
  kFailed,       // from the program: why the file cannot be read
};

struct FileMessage {
  FileTalk kind = FileTalk::kFailed;
  std::vector<std::byte> bytes;
};

struct MeshRequest {
  std::string name;  // of the file; files that it refers to are relative to it
  std::string bytes;
  std::array<double, 3> scale{1, 1, 1};
  std::string part;  // the only part to read; empty: all
};

struct MeshAnswer {
  std::vector<std::string> warnings;
  MeshParts parts;
};

/// Heights from 0 to 65535, row by row, top row first.
struct Heights {
  int width = 0, height = 0;
  std::vector<std::uint16_t> values;

  /// The interpolated height, from 0 to 1, at x and y from 0 to 1.
  double At(double x, double y) const;
};

/// Serialize messages and back; nullopt for bad bytes.
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

/// Transfer a message over a connected SOCK_STREAM socket. Return false or nullopt if the other end is gone,
/// sends an invalid message, or is silent for `patience_s` (< 0: no limit).
bool SendMessage(int socket, FileTalk kind, std::span<const std::byte> bytes);
std::optional<FileMessage> ReceiveMessage(int socket, int patience_s);

}  // namespace coopdyn
