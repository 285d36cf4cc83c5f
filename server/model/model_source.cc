// SPDX-License-Identifier: MIT
#include "server/model/model_source.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <set>
#include <span>
#include <string_view>
#include <utility>

#include "server/model/image_file.h"
#include "server/model/sdf_parts.h"
#include "server/model/text_file.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

constexpr std::string_view kMeshMark = "<!--coopdyn:mesh ";
constexpr std::string_view kTextureKey = "texture";  // in place of a mesh's key
constexpr int kMaxIncludes = 1000;
constexpr int kMaxDepth = 10;                  // of nested includes
constexpr std::size_t kMaxIncluded = 100'000;  // total elements of all includes

std::size_t CountElements(const XmlNode& node) {
  std::size_t count = 1;
  for (const XmlNode& child : node.children) count += CountElements(child);
  return count;
}

/// Replaces each `<include>` by the model that it names.
class Includer {
 public:
  /// `leaves_out`: leave out missing models with a warning.
  Includer(const Resources* resources, bool leaves_out, Diagnostics& diagnostics)
      : resources_(resources), leaves_out_(leaves_out), diagnostics_(diagnostics) {}

  bool has_left_out() const { return leaves_out_ && !missing_.empty(); }
  /// The missing models: "'URI' and 2 more".
  std::string left_out() const {
    const std::string more =
        missing_.size() < 2 ? "" : " and " + std::to_string(missing_.size() - 1) + " more";
    return "'" + *missing_.begin() + "'" + more + " (a warning each)";
  }

  void Expand(XmlNode& parent, int depth) {
    std::vector<XmlNode> all;
    for (XmlNode& child : parent.children) {
      if (child.name == "include") {
        auto model = Load(child, depth);
        if (!model) continue;
        if (parent.name == "model") SettlePlacement(*model, diagnostics_);
        if (parent.name == "model" && IsMerged(child, *model)) {
          std::ranges::move(PartsToMerge(std::move(*model)), std::back_inserter(all));
        } else {
          all.push_back(std::move(*model));
        }
        continue;
      }
      if (child.name == "model" || child.name == "world") Expand(child, depth);
      if (child.name == "model" && parent.name == "model") SettlePlacement(child, diagnostics_);
      all.push_back(std::move(child));
    }
    parent.children = std::move(all);
    if (parent.name == "model") RaiseJoints(parent, diagnostics_);
  }

 private:
  void Error(const XmlNode& at, std::string text) { diagnostics_.Error(at.where, std::move(text)); }

  /// True for two models that Gazebo's worlds include and download. coopdyn does not need their files.
  static bool IsLightOrFloor(const std::string& uri) {
    const std::string name = ToLower(uri.substr(uri.find_last_of('/') + 1));
    return name == "sun" || name == "ground_plane" || name == "ground plane";
  }

  /// True if the parts of `model` become parts of the including model.
  bool IsMerged(const XmlNode& include, const XmlNode& model) {
    if (include.Attribute("merge") != "true" && include.Attribute("merge") != "1") return false;
    const std::string fixed = model.TextOf("static");
    if (fixed != "1" && fixed != "true") return true;
    diagnostics_.Mended(include.where,
                        "merge of an <include> with <static> is not used: its parts are called " +
                            model.Attribute("name") + "::PART");
    return false;
  }

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
      // A world may include the same file a hundred times: report it once.
      if (IsLightOrFloor(uri) || !missing_.insert(uri).second) return std::nullopt;
      if (leaves_out_) {
        diagnostics_.Warning(include.where, "<include>: " + why +
                                                "; until then it is left out (--strict makes this an error)");
      } else {
        Error(include, "<include>: " + why);
      }
      return std::nullopt;
    }
    const Included& included = Read(path->string(), include);
    if (!included.root) return std::nullopt;
    elements_ += included.elements;
    if (elements_ > kMaxIncluded) {
      if (elements_ <= kMaxIncluded + included.elements)
        Error(include, "what this file includes has more than " + std::to_string(kMaxIncluded) +
                           " elements together: include fewer models, or simpler ones");
      return std::nullopt;
    }
    std::optional<XmlNode> root = included.root;
    if (root->Child("include") != nullptr) Expand(*root, depth + 1);
    XmlNode* model = root->Child("model");
    if (root->name == "sdf" && model == nullptr && root->Child("light") != nullptr) {
      diagnostics_.Note(include.where, "<include>: '" + uri + "' is a light, which is not used by coopdyn");
      return std::nullopt;
    }
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
    for (const XmlNode& child : include.children) {
      if (child.name == "plugin") made.children.push_back(child);
    }
    return made;
  }

  /// A file as SDF, with unexpanded includes.
  struct Included {
    std::optional<XmlNode> root;
    std::size_t elements = 0;
  };

  /// Reads and caches a file.
  const Included& Read(const std::string& file, const XmlNode& include) {
    const auto [known, is_new] = files_.try_emplace(file);
    Included& included = known->second;
    if (!is_new) return included;
    const auto text = ReadTextFile(file, include.where, diagnostics_);
    if (text) included.root = ParseXml(*text, file, diagnostics_);
    if (!included.root) return included;
    if (included.root->name == "robot") included.root = SdfOfUrdf(*included.root, diagnostics_);
    included.elements = CountElements(*included.root);
    return included;
  }

  const Resources* resources_;
  const bool leaves_out_;
  Diagnostics& diagnostics_;
  int count_ = 0;
  std::size_t elements_ = 0;
  std::set<std::string> missing_;
  std::map<std::string, Included> files_;
};

/// Moves the meshes at the end of a composed text to `table`. False if they are damaged.
bool TakeMeshes(std::string& text, MeshTable& table) {
  const std::size_t start = text.find("\n" + std::string(kMeshMark));
  if (start == std::string::npos) return true;
  std::string_view rest = std::string_view(text).substr(start + 1);
  std::size_t triangles = 0;
  FileReader reader;
  MeshTextures textures;
  while (rest.starts_with(kMeshMark)) {
    rest.remove_prefix(kMeshMark.size());
    const std::size_t space = rest.find(' '), end = rest.find("-->");
    if (space == std::string_view::npos || end == std::string_view::npos || space > end) return false;
    const std::string_view key = rest.substr(0, space), word = rest.substr(space + 1, end - space - 1);
    if (key == kTextureKey) {
      const auto bytes = FromBase64(word);
      std::string why;
      if (!bytes) return false;
      textures.push_back(reader.ReadTexture(*bytes, why));
      if (textures.back() == nullptr) return false;
    } else {
      auto mesh = MeshFromText(word, textures);
      if (!mesh) return false;
      triangles += mesh->data->triangles.size();
      if (triangles > kMaxModelTriangles) return false;
      table.emplace(std::string(key), std::move(*mesh));
    }
    rest.remove_prefix(end + 3);
    while (rest.starts_with('\n')) rest.remove_prefix(1);
  }
  text.resize(start + 1);
  return true;
}

}  // namespace

bool HasOwnElements(const XmlNode& node) {
  if (node.name.starts_with("coopdyn:") || node.Has("coopdyn:color")) return true;
  return std::ranges::any_of(node.children, HasOwnElements);
}

bool HasAny(const XmlNode& node, std::string_view name) {
  return node.name == name ||
         std::ranges::any_of(node.children, [&](const XmlNode& c) { return HasAny(c, name); });
}

void ExpandIncludes(XmlNode& root, const Resources* resources, Diagnostics& diagnostics) {
  const bool is_strict = resources == nullptr || resources->is_strict() || HasOwnElements(root);
  Includer includer(resources, root.name == "world" && !is_strict, diagnostics);
  includer.Expand(root, 0);
  if (includer.has_left_out() && root.Child("model") == nullptr)
    diagnostics.Error(root.where, "nothing that this world includes is there: " + includer.left_out());
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
  if (root->Child("include") != nullptr) {
    Upgrade(*root, version);
    ExpandIncludes(*root, resources, diagnostics);
    if (diagnostics.has_errors()) return std::nullopt;
  }
  XmlNode* model = root->Child("model");
  if (model == nullptr && root->Child("world") != nullptr) {
    diagnostics.Error(root->Child("world")->where,
                      "this is a world, not a robot: load it as a scenario (coopdyn serve FILE)");
    return std::nullopt;
  }
  if (const auto models = std::ranges::count(root->children, "model", &XmlNode::name); models != 1) {
    diagnostics.Error(root->where, models == 0 ? "a robot's file holds a <model>, and this one has none"
                                               : "a robot's file holds one <model>, and this one " +
                                                     std::to_string(models) + ": name one of them, type " +
                                                     std::filesystem::path(file).filename().string() + "#" +
                                                     model->Attribute("name") +
                                                     ", or serve the file itself (coopdyn serve FILE)");
    return std::nullopt;
  }
  source.foreign = root->Attribute("coopdyn:foreign") == "true" || !HasOwnElements(*root);
  source.in_world = root->Attribute("coopdyn:in_world") == "true";
  source.lifts = root->Attribute("coopdyn:lift") == "true";
  const bool plain = !source.foreign && *minor >= 7 && *minor <= 9 && !HasAny(*root, "include") &&
                     !HasAny(*root, "mesh") && !HasAny(*root, "heightmap") && !HasAny(*root, "ellipsoid") &&
                     !HasAny(*root, "cone") && !HasAny(*root, "pbr") && !HasAny(*root, "mimic") &&
                     !HasAny(*root, "screw_thread_pitch") && !HasChains(*root);
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
  root.Child("model")->Remove("placement_frame");  // the scenario places the model
  ExpandChains(*root.Child("model"), diagnostics);
  GatherMimics(*root.Child("model"), source.foreign, diagnostics);
  FreeNames(*root.Child("model"), diagnostics);
  if (source.foreign) {
    NumberSensors(*root.Child("model"), diagnostics);
    FixStillJoints(*root.Child("model"), diagnostics);
    CheckCanonicalLink(*root.Child("model"), resources != nullptr && resources->is_strict(), diagnostics);
  }
  CheckNames(*root.Child("model"), diagnostics);
  if (source.foreign) {
    root.Set("coopdyn:foreign", "true");
    if (source.in_world) root.Set("coopdyn:in_world", "true");
    AdoptModel(*root.Child("model"), resources, diagnostics);
  }
  MakeRoundMeshes(*root.Child("model"), source.meshes, diagnostics);
  LoadMeshes(root, resources, source.meshes, diagnostics);
  source.text = PrintXml(root, source.lines);
}

std::string WithMeshes(const ModelSource& source) {
  std::string text = source.text, meshes;
  MeshTextures textures;  // written before the meshes, which refer to them
  const auto line = [](const std::string& key, const std::string& word) {
    return std::string(kMeshMark) + key + " " + word + "-->\n";
  };
  for (const auto& [key, mesh] : source.meshes) meshes += line(key, MeshToText(mesh, textures));
  for (const auto& texture : textures)
    text += line(std::string(kTextureKey), ToBase64(EncodeTexture(*texture)));
  return text + meshes;
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
    Diagnostic moved = one;
    moved.where = std::move(where);
    diagnostics.Add(std::move(moved));
  }
}

}  // namespace coopdyn
