// SPDX-License-Identifier: MIT
#include "server/model/model_source.h"

#include <algorithm>
#include <array>
#include <set>
#include <string_view>
#include <utility>

#include "server/model/sdf_parts.h"
#include "server/model/text_file.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

constexpr std::string_view kMeshMark = "<!--coopdyn:mesh ";
constexpr int kMaxIncludes = 200;
constexpr int kMaxDepth = 10;  // of includes in includes

/// Minor number of an SDF version 1.x; nothing for anything else.
std::optional<int> MinorOf(const std::string& version) {
  if (!version.starts_with("1.") || version.size() > 4) return std::nullopt;
  const auto minor = ParsePlain(version.substr(2));
  if (!minor || *minor < 0 || version.find_first_not_of("0123456789.") != std::string::npos)
    return std::nullopt;
  return static_cast<int>(*minor);
}

bool HasOwnElements(const XmlNode& node) {
  if (node.name.starts_with("coopdyn:") || node.Has("coopdyn:color") || node.Has("xmlns:coopdyn"))
    return true;
  return std::ranges::any_of(node.children, HasOwnElements);
}

bool HasAny(const XmlNode& node, std::string_view name) {
  return node.name == name ||
         std::ranges::any_of(node.children, [&](const XmlNode& c) { return HasAny(c, name); });
}

/// Writes what `<include>` names in its place.
class Includer {
 public:
  Includer(const Resources* resources, Diagnostics& diagnostics)
      : resources_(resources), diagnostics_(diagnostics) {}

  void Expand(XmlNode& parent, int depth) {
    std::vector<XmlNode> all;
    for (XmlNode& child : parent.children) {
      if (child.name == "include") {
        if (auto model = Load(child, depth)) all.push_back(std::move(*model));
        continue;
      }
      if (child.name == "model" || child.name == "world") Expand(child, depth);
      all.push_back(std::move(child));
    }
    parent.children = std::move(all);
  }

 private:
  void Error(const XmlNode& at, std::string text) { diagnostics_.Error(at.where, std::move(text)); }

  std::optional<XmlNode> Load(const XmlNode& include, int depth) {
    const std::string uri = include.TextOf("uri");
    if (resources_ == nullptr) {
      Error(include, "<include> needs files, and this model came without: write out what it names");
      return std::nullopt;
    }
    if (++count_ > kMaxIncludes || depth >= kMaxDepth) {
      if (count_ <= kMaxIncludes + 1)
        Error(include, "more than " + std::to_string(kMaxIncludes) + " includes, or " +
                           std::to_string(kMaxDepth) + " inside each other: does a model include itself?");
      return std::nullopt;
    }
    std::string why;
    auto path = resources_->Find(uri, include.where.file, why);
    if (path && std::filesystem::is_directory(*path)) {
      const std::filesystem::path folder = *path;
      path = ModelFileIn(folder);
      if (!path) why = "the folder of '" + uri + "' has no model.sdf, model.urdf or model.config";
    }
    if (!path) {
      Error(include, "<include>: " + why);
      return std::nullopt;
    }
    const std::string file = path->string();
    const auto text = ReadTextFile(file, include.where, diagnostics_);
    if (!text) return std::nullopt;
    auto root = ParseXml(*text, file, diagnostics_);
    if (!root) return std::nullopt;
    if (root->name == "robot") root = SdfOfUrdf(*root, diagnostics_);
    XmlNode* model = root->Child("model");
    if (root->name != "sdf" || model == nullptr) {
      Error(include, "<include>: '" + uri + "' holds no <model>");
      return std::nullopt;
    }
    Upgrade(*root, root->Attribute("version"));
    XmlNode made = std::move(*model);
    Expand(made, depth + 1);
    for (const char* key : {"name", "pose", "static"}) {
      const XmlNode* given = include.Child(key);
      if (given == nullptr) continue;
      if (given->name == "name") {
        made.Set("name", given->text);
        continue;
      }
      std::erase_if(made.children, [key](const XmlNode& one) { return one.name == key; });
      made.children.push_back(*given);
    }
    if (include.Has("placement_frame") || include.Child("placement_frame") != nullptr)
      made.Set("placement_frame", include.TextOf("placement_frame"));
    if (include.Has("merge"))
      diagnostics_.Warning(include.where, "merge of <include> is not used: its parts are called " +
                                              made.Attribute("name") + "::PART");
    for (const XmlNode& child : include.children) {
      if (child.name == "plugin") made.children.push_back(child);
    }
    return made;
  }

  const Resources* resources_;
  Diagnostics& diagnostics_;
  int count_ = 0;
};

/// Loads the meshes that `node` names, and calls them mesh:1, mesh:2, …
class MeshLoader {
 public:
  MeshLoader(const Resources* resources, MeshTable& table, Diagnostics& diagnostics)
      : resources_(resources), table_(table), diagnostics_(diagnostics) {}

  /// `shape`: the collision or visual around `node`. False if its mesh cannot be used.
  bool Load(XmlNode& node, bool is_visual = false) {
    if (node.name == "mesh" && node.Child("uri") != nullptr) return LoadOne(node, is_visual);
    const bool visual = is_visual || node.name == "visual";
    bool good = true;
    for (auto it = node.children.begin(); it != node.children.end();) {
      const bool fine = Load(*it, visual);
      // A picture may go without a shape, the physics may not.
      if (!fine && it->name == "visual") {
        it = node.children.erase(it);
        continue;
      }
      good = good && fine;
      ++it;
    }
    return good;
  }

 private:
  bool LoadOne(XmlNode& mesh, bool is_visual) {
    XmlNode& uri = *mesh.Child("uri");
    if (table_.contains(uri.text)) return true;
    Diagnostics found;
    const std::string key = Key(mesh, uri, found);
    for (const Diagnostic& one : found.all()) {
      if (is_visual) {
        diagnostics_.Warning(one.where, one.text + " (it is not drawn)");
      } else {
        diagnostics_.Error(one.where, one.text);
      }
    }
    if (key.empty()) return false;
    uri.text = key;
    std::erase_if(mesh.children, [](const XmlNode& one) { return one.name != "uri"; });
    return true;
  }

  std::string Key(const XmlNode& mesh, const XmlNode& uri, Diagnostics& found) {
    Vector3 scale = Vector3::Ones();
    const std::string scale_text = mesh.TextOf("scale");
    if (!scale_text.empty()) {
      const std::vector<std::string> words = SplitWords(scale_text);
      for (std::size_t i = 0; i < 3; ++i) {
        // URDF allows one number.
        const auto value = words.size() == 3 || words.size() == 1
                               ? ParsePlain(words[words.size() == 3 ? i : 0])
                               : std::nullopt;
        if (!value || *value == 0) {
          found.Error(uri.where,
                      "<scale> of a mesh is three finite numbers, none of them 0, not '" + scale_text + "'");
          return {};
        }
        scale[static_cast<Eigen::Index>(i)] = *value;
      }
    }
    const XmlNode* submesh = mesh.Child("submesh");
    const std::string part = submesh == nullptr ? "" : submesh->TextOf("name");
    const bool centred =
        submesh != nullptr && (submesh->TextOf("center") == "true" || submesh->TextOf("center") == "1");
    if (resources_ == nullptr) {
      found.Error(uri.where,
                  "the mesh '" + uri.text +
                      "' is a file, and this model came without: use box, cylinder, sphere or capsule");
      return {};
    }
    std::string why;
    const auto file = resources_->Find(uri.text, uri.where.file, why);
    if (!file) {
      found.Error(uri.where, "mesh: " + why);
      return {};
    }
    const std::string what = file->string() + "|" + FormatNumber(scale.x()) + " " + FormatNumber(scale.y()) +
                             " " + FormatNumber(scale.z()) + "|" + part + (centred ? "|c" : "");
    if (const auto known = keys_.find(what); known != keys_.end()) return known->second;
    auto loaded = LoadMesh(*file, scale, part, uri.where, found);
    if (!loaded) return {};
    triangles_ += loaded->data->triangles.size();
    if (triangles_ > kMaxModelTriangles) {
      found.Error(uri.where, "the meshes of a model have at most " + std::to_string(kMaxModelTriangles) +
                                 " triangles together: simplify them");
      return {};
    }
    if (centred) loaded->middle.setZero();
    std::string key = "mesh:" + std::to_string(table_.size() + 1);
    table_.emplace(key, std::move(*loaded));
    keys_.emplace(what, key);
    return key;
  }

  const Resources* resources_;
  MeshTable& table_;
  Diagnostics& diagnostics_;
  std::map<std::string, std::string> keys_;
  std::size_t triangles_ = 0;
};

/// Cuts off the meshes behind a composed text.
bool TakeMeshes(std::string& text, MeshTable& table) {
  const std::size_t start = text.find("\n" + std::string(kMeshMark));
  if (start == std::string::npos) return true;
  std::string_view rest = std::string_view(text).substr(start + 1);
  std::size_t triangles = 0;
  while (rest.starts_with(kMeshMark)) {
    rest.remove_prefix(kMeshMark.size());
    const std::size_t space = rest.find(' '), end = rest.find("-->");
    if (space == std::string_view::npos || end == std::string_view::npos || space > end) return false;
    auto mesh = MeshFromText(rest.substr(space + 1, end - space - 1));
    if (!mesh) return false;
    triangles += mesh->data->triangles.size();
    if (triangles > kMaxModelTriangles) return false;
    table.emplace(std::string(rest.substr(0, space)), std::move(*mesh));
    rest.remove_prefix(end + 3);
    while (rest.starts_with('\n')) rest.remove_prefix(1);
  }
  text.resize(start + 1);
  return true;
}

}  // namespace

void Upgrade(XmlNode& node, const std::string& version) {
  const int minor = MinorOf(version).value_or(9);
  if (node.name == "sdf") node.Set("version", "1.9");
  if (minor < 7) {
    if (node.Has("frame") && node.name == "pose") {
      const std::string frame = node.Attribute("frame");
      node.Remove("frame");
      if (!frame.empty()) node.Set("relative_to", frame);
    }
    if (node.name == "axis" || node.name == "axis2") {
      const std::string flag = node.TextOf("use_parent_model_frame");
      const bool in_model = minor < 5 || flag == "1" || flag == "true";
      std::erase_if(node.children, [](const XmlNode& one) {
        return one.name == "use_parent_model_frame" || one.name == "initial_position";
      });
      XmlNode* xyz = node.Child("xyz");
      if (in_model && xyz != nullptr) xyz->Set("expressed_in", "__model__");
    }
  }
  for (XmlNode& child : node.children) Upgrade(child, version);
}

void ExpandIncludes(XmlNode& world, const Resources* resources, Diagnostics& diagnostics) {
  Includer(resources, diagnostics).Expand(world, 0);
}

std::optional<ModelSource> ComposeModel(const std::string& given, const std::string& file,
                                        const Resources* resources, Diagnostics& diagnostics) {
  ModelSource source;
  std::string text = given;
  if (!TakeMeshes(text, source.meshes)) {
    diagnostics.Error({file, 0}, "the meshes behind the model are damaged: read it from its own file again");
    return std::nullopt;
  }
  std::optional<XmlNode> root = ParseXml(text, file, diagnostics);
  if (!root) return std::nullopt;
  const bool urdf = root->name == "robot";
  if (urdf) root = SdfOfUrdf(*root, diagnostics);
  if (root->name != "sdf") {
    diagnostics.Error(root->where,
                      "a robot model starts with <sdf version=\"1.9\"> or <robot name=\"…\"> (URDF)");
    return std::nullopt;
  }
  const std::string version = root->Attribute("version");
  const auto minor = MinorOf(version);
  if (!minor || *minor < 3) {
    diagnostics.Error(root->where, "SDF version '" + version + "' is not supported: write version=\"1.9\"");
    return std::nullopt;
  }
  XmlNode* model = root->Child("model");
  if (model == nullptr && root->Child("world") != nullptr) {
    diagnostics.Error(root->Child("world")->where,
                      "this is a world, not a robot: load it as a scenario (coopdyn serve FILE)");
    return std::nullopt;
  }
  if (std::ranges::count(root->children, "model", &XmlNode::name) != 1) {
    diagnostics.Error(root->where, "a robot's file holds exactly one <model>");
    return std::nullopt;
  }
  source.foreign = root->Attribute("coopdyn:foreign") == "true" || !HasOwnElements(*root);
  const bool plain = !source.foreign && *minor >= 7 && *minor <= 9 && !HasAny(*root, "include") &&
                     !HasAny(*root, "mesh") && !HasAny(*root, "mimic") &&
                     !HasAny(*root, "screw_thread_pitch");
  if (plain && !root->Has("xmlns:coopdyn")) {
    diagnostics.Error(root->where,
                      "write xmlns:coopdyn=\"https://coopdyn.dev/sdf\" in <sdf>: a robot needs elements "
                      "of this namespace (docs/formats.md)");
  }
  if (plain) {
    source.text = given;
    return source;
  }
  ComposeTree(std::move(*root), resources, source, diagnostics);
  return source;
}

void ComposeTree(XmlNode root, const Resources* resources, ModelSource& source, Diagnostics& diagnostics) {
  Upgrade(root, root.Attribute("version"));
  root.Set("xmlns:coopdyn", "https://coopdyn.dev/sdf");
  ExpandIncludes(root, resources, diagnostics);
  GatherMimics(*root.Child("model"));
  FreeNames(*root.Child("model"), diagnostics);
  if (source.foreign) {
    root.Set("coopdyn:foreign", "true");
    AdoptModel(*root.Child("model"), diagnostics);
  }
  MeshLoader(resources, source.meshes, diagnostics).Load(root);
  source.text = PrintXml(root, source.lines);
}

std::string WithMeshes(const ModelSource& source) {
  std::string text = source.text;
  for (const auto& [key, mesh] : source.meshes) {
    text += std::string(kMeshMark) + key + " " + MeshToText(mesh) + "-->\n";
  }
  return text;
}

void AppendMapped(const Diagnostics& found, const std::string& file, const ModelSource& source,
                  Diagnostics& diagnostics) {
  if (source.lines.empty()) {
    diagnostics.Append(found);
    return;
  }
  for (const Diagnostic& one : found.all()) {
    SourceLine where = one.where;
    const auto line = static_cast<std::size_t>(where.line);
    if (where.file == file && line >= 1 && line <= source.lines.size()) where = source.lines[line - 1];
    if (one.level == Diagnostic::Level::kError) {
      diagnostics.Error(where, one.text);
    } else {
      diagnostics.Warning(where, one.text);
    }
  }
}

}  // namespace coopdyn
