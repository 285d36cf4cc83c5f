// SPDX-License-Identifier: MIT
// The meshes of a model as files, each written when it is first named. One thread.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>

#include "server/mjcf/source.h"

namespace coopdyn::mjcf {

class Meshes {
 public:
  /// Files go to `folder`; in the SDF they are `prefix` + name.
  Meshes(const Source& source, std::filesystem::path folder, std::string prefix)
      : source_(source), folder_(std::move(folder)), prefix_(std::move(prefix)) {}

  /// The <uri> of the mesh, and its <scale>, mostly empty.
  struct Named {
    std::string uri, scale;
  };
  Named Mesh(int mesh);
  /// Of a height field, as a mesh.
  Named Heights(int field);
  bool failed() const { return failed_; }  // a file could not be written

 private:
  struct Triangles;
  /// A name for a file that no other has.
  std::string NewFile(const std::string& name);
  std::string Copy(const UnreadMesh& mesh);
  std::string Write(const std::string& name, const Triangles& triangles);

  const Source& source_;
  const std::filesystem::path folder_;
  const std::string prefix_;
  std::map<std::string, Named> written_;       // by kind and index
  std::map<std::string, std::string> copied_;  // the file's name here, by its path
  std::set<std::string> files_;                // names that are taken
  bool failed_ = false;
};

}  // namespace coopdyn::mjcf
