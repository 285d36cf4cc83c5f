// SPDX-License-Identifier: MIT
// Loads the files that the shapes of a model name: meshes, heightmaps and textures.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <set>
#include <utility>

#include "server/files/reduce_mesh.h"
#include "server/geometry/convex_parts.h"
#include "server/model/image_file.h"
#include "server/model/made_meshes.h"
#include "server/model/model_source.h"
#include "server/model/stand_in.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

/// Loads meshes as mesh:1, mesh:2, …
class MeshLoader {
 public:
  /// `is_foreign`: the model was made for other programs.
  MeshLoader(const Resources* resources, bool is_foreign, MeshTable& table, Diagnostics& diagnostics)
      : resources_(resources),
        table_(table),
        diagnostics_(diagnostics),
        fills_gaps_(is_foreign && resources != nullptr && !resources->is_strict()) {}

  void LoadAll(XmlNode& root) {
    to_come_ = Count(root);
    Load(root);
  }

 private:
  /// `is_visual`: `node` is in a visual. False if its mesh cannot be used.
  bool Load(XmlNode& node, bool is_visual = false) {
    if (IsNamed(node)) return LoadOne(node, is_visual);
    const bool visual = is_visual || node.name == "visual";
    if (node.name == "visual") TakeTexture(node);
    if (node.name == "link") stand_in_ = StandIn::Of(node);
    bool good = true;
    for (auto it = node.children.begin(); it != node.children.end();) {
      const bool fine = Load(*it, visual);
      // A visual may lose its shape, a collision may not.
      if (!fine && it->name == "visual") {
        it = node.children.erase(it);
        continue;
      }
      if (!fine && it->name == "collision" && is_missing_ && fills_gaps_) {
        if (!stand_in_ || !stand_in_->PutInto(*it)) {
          it = node.children.erase(it);
          continue;
        }
      } else {
        good = good && fine;
      }
      ++it;
    }
    return good;
  }

  static bool IsNamed(const XmlNode& node) {
    return node.name == "heightmap" || (node.name == "mesh" && node.Child("uri") != nullptr);
  }
  static std::size_t Count(const XmlNode& node) {
    std::size_t count = IsNamed(node) ? 1 : 0;
    for (const XmlNode& child : node.children) count += Count(child);
    return count;
  }

  bool LoadOne(XmlNode& mesh, bool is_visual) {
    if (to_come_ > 0) --to_come_;  // textured boxes become additional meshes
    if (mesh.Child("uri") == nullptr) mesh.Add("uri");
    XmlNode& uri = *mesh.Child("uri");
    if (table_.contains(uri.text)) return true;
    Diagnostics found;
    is_missing_ = false;
    std::string key = mesh.name == "heightmap" ? HeightsKey(mesh, uri, found) : Key(mesh, uri, found);
    if (is_visual && !key.empty() && texture_ != nullptr) key = Dressed(key);
    if (!key.empty()) ReadOptimization(mesh);
    if (!is_missing_ || reported_.emplace(uri.text, is_visual).second) Say(found, is_visual);
    if (key.empty()) return false;
    uri.text = key;
    mesh.name = "mesh";
    std::erase_if(mesh.children, [](const XmlNode& one) { return one.name != "uri"; });
    return true;
  }

  /// Translates SDF 1.11's `optimization` of a collision mesh.
  void ReadOptimization(XmlNode& mesh) {
    const std::string word = mesh.Attribute("optimization");
    mesh.Remove("optimization");
    if (word == "convex_hull") {
      mesh.Set(kPartsAttribute, "1");
    } else if (word == "convex_decomposition") {
      const XmlNode* how = mesh.Child("convex_decomposition");
      const std::string most = how == nullptr ? "" : how->TextOf("max_convex_hulls");
      const auto count = most.empty() ? std::optional(double{kMostConvexParts}) : ParsePlain(most);
      if (count && *count >= 1 && *count == std::floor(*count)) {
        mesh.Set(kPartsAttribute, FormatNumber(std::min(*count, double{kMostWantedParts})));
      } else {
        diagnostics_.Error(how->where, "<max_convex_hulls> is a whole number from 1 on, not '" + most + "'");
      }
    } else if (!word.empty()) {
      diagnostics_.Warning(mesh.where, "optimization=\"" + word +
                                           "\" of a <mesh> is not known: write convex_hull or "
                                           "convex_decomposition");
    }
  }

  void Say(const Diagnostics& found, bool is_visual) {
    for (const Diagnostic& one : found.all()) {
      if (one.level != Diagnostic::Level::kError) {
        diagnostics_.Add(one);
      } else if (is_visual) {
        diagnostics_.Note(one.where, one.text + " (it is not drawn)");
      } else if (is_missing_ && fills_gaps_) {
        diagnostics_.Warning(one.where, one.text + "; until then " +
                                            (stand_in_ ? "a box that has the link's inertia collides"
                                                       : "nothing collides, as the link has no inertia") +
                                            " (--strict makes this an error)");
      } else {
        diagnostics_.Error(one.where, one.text);
      }
    }
  }

  std::string Key(const XmlNode& mesh, const XmlNode& uri, Diagnostics& found) {
    Vector3 scale = Vector3::Ones();
    const std::string scale_text = mesh.TextOf("scale");
    if (!scale_text.empty()) {
      const std::vector<std::string> words = SplitWords(scale_text);
      for (std::size_t i = 0; i < 3; ++i) {
        // URDF allows one number; some models have a fourth.
        const auto value = words.size() == 1                        ? ParsePlain(words[0])
                           : words.size() == 3 || words.size() == 4 ? ParsePlain(words[i])
                                                                    : std::nullopt;
        if (!value || *value == 0) {
          found.Error(uri.where,
                      "<scale> of a mesh is three finite numbers, none of them 0, not '" + scale_text + "'");
          return {};
        }
        scale[static_cast<Eigen::Index>(i)] = *value;
      }
      if (words.size() == 4)
        found.Mended(uri.where,
                     "<scale> of a mesh is three numbers: the fourth of '" + scale_text + "' is left out");
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
      is_missing_ = true;
      return {};
    }
    const std::string what = file->string() + "|" + FormatNumber(scale.x()) + " " + FormatNumber(scale.y()) +
                             " " + FormatNumber(scale.z()) + "|" + part + (centred ? "|c" : "");
    is_missing_ = !IsMeshType(*file);  // treat unsupported formats as missing
    const auto known = keys_.find(what);
    if (known != keys_.end() && !is_missing_) return Known(known->second, uri, found);
    keys_.emplace(what, "");
    auto loaded = LoadMesh(*file, scale, part, *resources_, reader_, uri.where, found);
    if (!loaded) return {};
    if (centred) {
      const MeshData& data = *loaded->data;  // centred at its middle
      loaded = MakeModelMesh({data.vertices, data.triangles, data.color, data.skin});
    }
    return Keep(what, std::move(*loaded), uri, found);
  }

  std::string Keep(const std::string& what, ModelMesh mesh, const XmlNode& at, Diagnostics& found) {
    const std::string name = at.name == "uri" ? at.text : at.name;
    const std::size_t left = kMaxModelTriangles - triangles_, count = mesh.data->triangles.size();
    // Reserve triangles for the remaining meshes.
    const std::size_t few = kFewTriangles * to_come_;
    const std::size_t most = left > 2 * few ? left - few : left / (to_come_ + 1);
    if (count > most && most > 0 && !mesh.is_heights) {
      const MeshData& data = *mesh.data;
      MeshParts parts{data.vertices, data.triangles, data.color, data.skin};
      for (Vector3& v : parts.vertices) v += mesh.middle;
      ReducedMesh reduced = Reduce(std::move(parts), most);
      found.Mended(at.where, "'" + name + "': " + ReductionText(count, reduced) +
                                 " (the meshes of a model have at most " +
                                 std::to_string(kMaxModelTriangles) + " together)");
      mesh = MakeModelMesh(std::move(reduced.parts));
    }
    triangles_ += mesh.data->triangles.size();
    if (triangles_ > kMaxModelTriangles) {
      found.Error(at.where, "the meshes of a model have at most " + std::to_string(kMaxModelTriangles) +
                                " triangles together: simplify them");
      return {};
    }
    std::string key = "mesh:" + std::to_string(table_.size() + 1);
    table_.emplace(key, std::move(mesh));
    keys_[what] = key;
    return key;
  }

  /// Returns `key`, or reports that the file failed before: rejecting a damaged file may take seconds.
  static std::string Known(const std::string& key, const XmlNode& uri, Diagnostics& found) {
    if (key.empty()) found.Error(uri.where, "'" + uri.text + "' cannot be used, as is said above");
    return key;
  }

  /// The three numbers in a child of `node`; `otherwise` if it is missing.
  static std::optional<Vector3> VectorOf(const XmlNode& node, const char* child, const Vector3& otherwise) {
    const std::string text = node.TextOf(child);
    if (text.empty()) return otherwise;
    const std::vector<std::string> words = SplitWords(text);
    Vector3 out;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto value = words.size() == 3 ? ParsePlain(words[i]) : std::nullopt;
      if (!value || std::abs(*value) > 1e4) return std::nullopt;
      out[static_cast<Eigen::Index>(i)] = *value;
    }
    return out;
  }

  std::string HeightsKey(const XmlNode& node, const XmlNode& uri, Diagnostics& found) {
    const auto fail = [&](const std::string& text) {
      found.Error(uri.where, "heightmap: " + text);
      return std::string();
    };
    const auto size = VectorOf(node, "size", Vector3::Ones()), pos = VectorOf(node, "pos", Vector3::Zero());
    const auto sampling = node.TextOf("sampling").empty() ? 1 : ParsePlain(node.TextOf("sampling"));
    if (!size || !pos || size->x() <= 0 || size->y() <= 0)
      return fail("<size> and <pos> are three numbers of m, <size> above 0: length, width and height");
    if (!sampling || *sampling < 1 || *sampling > 16) return fail("<sampling> is a number from 1 to 16");
    if (resources_ == nullptr)
      return fail("the picture '" + uri.text + "' is a file, and this model came without");
    std::string why;
    const auto file = resources_->Find(uri.text, uri.where.file, why);
    if (!file) return fail(why);
    const auto text = [](const Vector3& v) {
      return FormatNumber(v.x()) + " " + FormatNumber(v.y()) + " " + FormatNumber(v.z()) + "|";
    };
    const std::string what = file->string() + "|" + text(*size) + text(*pos) + FormatNumber(*sampling);
    if (const auto known = keys_.find(what); known != keys_.end()) return Known(known->second, uri, found);
    keys_.emplace(what, "");
    const auto bytes = ReadImageFile(*file, why);
    const auto heights = bytes ? reader_.ReadHeights(*bytes, why) : std::nullopt;
    if (!heights) return fail("'" + uri.text + "': " + why);
    const int wanted[] = {static_cast<int>((heights->width - 1) * *sampling) + 1,
                          static_cast<int>((heights->height - 1) * *sampling) + 1};
    const int columns = std::clamp(wanted[0], 2, kMaxHeightSide),
              rows = std::clamp(wanted[1], 2, kMaxHeightSide);
    if (columns < wanted[0] || rows < wanted[1]) {
      found.Mended(uri.where, "the heightmap has " + std::to_string(wanted[0]) + " x " +
                                  std::to_string(wanted[1]) + " points, and " + std::to_string(columns) +
                                  " x " + std::to_string(rows) + " of them are taken: at most " +
                                  std::to_string(kMaxHeightSide) + " a side");
    }
    return Keep(what, MakeHeights(*heights, columns, rows, *size, *pos), uri, found);
  }

  /// Reads the texture of a visual's <material>. A textured box or plane becomes a mesh.
  void TakeTexture(XmlNode& visual) {
    texture_ = nullptr;
    XmlNode* material = visual.Child("material");
    XmlNode* pbr = material == nullptr ? nullptr : material->Child("pbr");
    if (pbr == nullptr) return;
    const XmlNode* flow = pbr->Child("metal") != nullptr ? pbr->Child("metal") : pbr->Child("specular");
    const XmlNode* map = flow == nullptr ? nullptr : flow->Child("albedo_map");
    if (map != nullptr && !map->text.empty()) texture_ = TextureOf(*map);
    const SourceLine where = map == nullptr ? SourceLine() : map->where;  // before its element is removed
    tint_ = {1, 1, 1};
    const std::vector<std::string> diffuse = SplitWords(material->TextOf("diffuse"));
    for (std::size_t c = 0; c < 3 && diffuse.size() >= 3; ++c)
      tint_[c] = std::clamp(ParsePlain(diffuse[c]).value_or(1), 0.0, 1.0);
    std::erase_if(material->children, [&](const XmlNode& one) {
      return one.name == "pbr" || (texture_ != nullptr && one.name == "diffuse");
    });
    XmlNode* geometry = visual.Child("geometry");
    if (texture_ == nullptr || geometry == nullptr || geometry->children.empty()) return;
    XmlNode& shape = geometry->children.front();
    if (shape.name == "mesh" || shape.name == "heightmap") return;
    if (shape.name != "box") {
      diagnostics_.Note(where, "textures are drawn on meshes and boxes, and not on <" + shape.name + ">");
      XmlNode& plain = material->Add("diffuse");
      const auto color = TexturedMaterial(texture_, tint_).color;
      plain.text =
          FormatNumber(color[0]) + " " + FormatNumber(color[1]) + " " + FormatNumber(color[2]) + " 1";
      return;
    }
    const auto size = VectorOf(shape, "size", Vector3::Ones());
    if (!size || !(size->minCoeff() > 0)) return;  // reported when the box is read
    const std::string key = Keep("", MakePictureBox(*size), shape, diagnostics_);
    if (key.empty()) return;
    shape.name = "mesh";
    shape.children.clear();
    shape.Add("uri", Dressed(key));
  }

  std::shared_ptr<const Image> TextureOf(const XmlNode& map) {
    std::string why = "this model came without its files";
    const auto file = resources_ == nullptr ? std::nullopt : resources_->Find(map.text, map.where.file, why);
    if (file) {
      if (const auto known = textures_.find(*file); known != textures_.end()) return known->second;
    }
    const auto bytes = file ? ReadImageFile(*file, why) : std::nullopt;
    auto texture = bytes ? reader_.ReadTexture(*bytes, why) : nullptr;
    if (texture == nullptr)
      diagnostics_.Note(map.where, "the texture '" + map.text + "' is not drawn: " + why);
    if (file) textures_[*file] = texture;
    return texture;
  }

  /// Adds a copy of the mesh `key` with the current texture and returns its key.
  std::string Dressed(const std::string& key) {
    std::string dressed = "mesh:" + std::to_string(table_.size() + 1);
    table_.emplace(dressed, InMaterial(table_.at(key), TexturedMaterial(texture_, tint_)));
    return dressed;
  }

  static constexpr int kMaxHeightSide = 257;
  static constexpr std::size_t kFewTriangles = 1000;

  const Resources* resources_;
  MeshTable& table_;
  Diagnostics& diagnostics_;
  const bool fills_gaps_;    // a missing mesh is not an error
  bool is_missing_ = false;  // the last mesh is missing or has an unsupported format
  std::set<std::pair<std::string, bool>>
      reported_;                     // reported missing files, and whether only visuals use them
  std::optional<StandIn> stand_in_;  // of the current link
  FileReader reader_;
  std::map<std::string, std::string> keys_;
  std::size_t triangles_ = 0;
  std::size_t to_come_ = 0;  // named meshes not loaded yet
  std::map<std::filesystem::path, std::shared_ptr<const Image>> textures_;
  std::shared_ptr<const Image> texture_;  // of the current visual
  std::array<double, 3> tint_{1, 1, 1};
};

}  // namespace

void LoadMeshes(XmlNode& root, const Resources* resources, MeshTable& table, Diagnostics& diagnostics) {
  MeshLoader(resources, root.Attribute("coopdyn:foreign") == "true", table, diagnostics).LoadAll(root);
}

}  // namespace coopdyn
