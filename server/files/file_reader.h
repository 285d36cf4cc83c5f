// SPDX-License-Identifier: MIT
// Reads meshes and pictures, which libraries of others understand: in a process of its own, the program
// coopdyn-files, with limits of time and memory. A file that breaks a library, or keeps it busy without end,
// is then a file that cannot be read. The process starts at the first file, and again after one that ended
// it. One thread at a time.
#pragma once

#include <sys/types.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "server/files/wire.h"

namespace coopdyn {

class FileReader {
 public:
  /// Of one file.
  struct Limits {
    int cpu_s = 10;
    int memory_mib = 2048;
  };
  /// The content of the file that the mesh calls `name`: a texture, or any other. Nothing, and `why`, if
  /// there is none.
  using Supply =
      std::function<std::optional<std::string>(bool is_texture, const std::string& name, std::string& why)>;

  FileReader() = default;
  explicit FileReader(Limits limits) : limits_(limits) {}
  ~FileReader() { End(); }
  FileReader(const FileReader&) = delete;
  FileReader& operator=(const FileReader&) = delete;

  /// Nothing, and `why` says what to do, for what cannot be read.
  std::optional<MeshAnswer> ReadMesh(const MeshRequest& request, const Supply& supply, std::string& why);
  std::shared_ptr<const Image> ReadTexture(std::string_view bytes, std::string& why);
  std::optional<Heights> ReadHeights(std::string_view bytes, std::string& why);

 private:
  /// The bytes of an answer of the kind `wanted`.
  std::optional<std::vector<std::byte>> Ask(FileTalk kind, std::span<const std::byte> bytes,
                                            const Supply& supply, FileTalk wanted, std::string& why);
  bool Start(std::string& why);
  /// Ends the process. Its wait status.
  int End();
  /// In words, from a wait status.
  std::string WhyEnded(int status) const;

  const Limits limits_;
  pid_t process_ = -1;
  int socket_ = -1;
};

}  // namespace coopdyn
