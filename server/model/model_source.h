// SPDX-License-Identifier: MIT
// Composes a model into one text for libsdformat: translates URDF into SDF, upgrades older SDF, expands
// <include>, loads meshes, and translates or reports what only Gazebo understands. One thread.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/diagnostics.h"
#include "server/model/mesh_file.h"
#include "server/model/resources.h"
#include "server/model/xml_tree.h"

namespace coopdyn {

/// Meshes by the <uri> in the text (mesh:1, mesh:2, …).
using MeshTable = std::map<std::string, ModelMesh>;

struct ModelSource {
  std::string text;               // SDF 1.9, without mesh data
  std::vector<SourceLine> lines;  // origin of each line of `text`; empty: `text` itself
  MeshTable meshes;
  /// Made for other programs: unusable parts are left out with a warning, and defaults fill gaps.
  bool foreign = false;
  bool in_world = false;  // a world places the model, so its origin must not move (coopdyn:in_world)
  std::filesystem::path parts_folder{};  // cache of convex parts (kept_parts.h)
  bool lifts = false;                    // lift a model that reaches below the floor onto it (coopdyn:lift)
};

/// `resources`: null for a text without files. Reports an error and returns nullopt if the text is unusable.
std::optional<ModelSource> ComposeModel(const std::string& text, const std::string& file,
                                        const Resources* resources, Diagnostics& diagnostics);

/// The same for an SDF `root` with one <model>. @pre source.foreign is set
void ComposeTree(XmlNode root, const Resources* resources, ModelSource& source, Diagnostics& diagnostics);

/// True if `node` or a descendant is or has something of coopdyn's own namespace.
bool HasOwnElements(const XmlNode& node);
/// True if `node` or a descendant has the element name `name`.
bool HasAny(const XmlNode& node, std::string_view name);

/// Maximum number of convex parts as which a mesh collides: an attribute of a composed <mesh>, from SDF's
/// `optimization`.
inline constexpr const char* kPartsAttribute = "coopdyn:parts";
inline constexpr int kMostWantedParts = 64;

/// Attributes of a composed text. kWeighAttribute on <inertial>: the link's mass is that of its collisions.
/// Each collision then has its density in kDensityAttribute. A collision that became a mesh has in
/// kSolidAttribute the volume, the moments for 1 kg, and the centre of mass's z of the solid that it
/// replaces.
inline constexpr const char* kWeighAttribute = "coopdyn:weigh";
inline constexpr const char* kDensityAttribute = "coopdyn:density";
inline constexpr const char* kSolidAttribute = "coopdyn:solid_of";

/// Loads the meshes, heightmaps and textures that `root` names as meshes mesh:1, mesh:2, …
void LoadMeshes(XmlNode& root, const Resources* resources, MeshTable& table, Diagnostics& diagnostics);

/// Replaces each `<ellipsoid>` and `<cone>` in `model` by a mesh. If it is the first shape of a link with
/// mass but without <inertia>, the link gets the inertia of the solid.
void MakeRoundMeshes(XmlNode& model, MeshTable& table, Diagnostics& diagnostics);

/// The text for a recording. It can be read without files and gives the same model.
std::string WithMeshes(const ModelSource& source);

/// Expands the includes of `root` (`<world>` or `<sdf>`). Missing files of a world made for other programs
/// are only warnings, unless all of its includes are missing.
void ExpandIncludes(XmlNode& root, const Resources* resources, Diagnostics& diagnostics);
/// The parts of `model` (`<model>`, with the <pose> of its <include>) as parts of the model that merges it.
std::vector<XmlNode> PartsToMerge(XmlNode model);
/// Converts the <pose> of `model` (`<model>` with expanded includes) from its placement_frame to its own
/// frame. Warns if placement_frame names no frame.
void SettlePlacement(XmlNode& model, Diagnostics& diagnostics);
/// The value of `<pose>`, also in degrees or with a quaternion; the identity for null.
Pose PoseOf(const XmlNode* pose);
/// Moves joints of models nested in `model` into `model` if they name its links, as Gazebo Classic does.
void RaiseJoints(XmlNode& model, Diagnostics& diagnostics);
/// Minor number of an SDF version 1.x; nullopt for anything else.
std::optional<int> MinorOf(const std::string& version);
/// Rewrites elements of older and newer SDF as SDF 1.9. `version`: that of the file of `root`.
void Upgrade(XmlNode& root, const std::string& version);

/// Rewrites joint elements of `model` (`<model>`) that libsdformat does not know: a `<mimic>` becomes a
/// `<coopdyn:mimic>` of the model, `<screw_thread_pitch>` the older `<thread_pitch>`. `is_foreign`: joints
/// that follow fixed joints become fixed, with a warning.
void GatherMimics(XmlNode& model, bool is_foreign, Diagnostics& diagnostics);

/// Rewrites joints with several axes in `model` (`<model>`), `<coopdyn:six_axis>` and SDF's revolute2, as
/// chains of joints with one axis each, with links without shapes (`coopdyn:carrier`) between them.
void ExpandChains(XmlNode& model, Diagnostics& diagnostics);
bool HasChains(const XmlNode& node);

/// Renames parts whose names libsdformat rejects: joints named like a link or `world` (`coopdyn:name` keeps
/// the original name), and shapes of a link with the same name. Treats a link `world` as the world itself.
void FreeNames(XmlNode& model, Diagnostics& diagnostics);
/// Renames sensors with the same name in a link or joint, and reports them.
void NumberSensors(XmlNode& model, Diagnostics& diagnostics);
/// Fixes joints whose axis has no direction and whose limits are both 0, by which some models attach force
/// sensors.
void FixStillJoints(XmlNode& model, Diagnostics& diagnostics);
/// Removes a canonical_link that names no link of its model, and reports it: as mended, or if `is_strict` as
/// an error.
void CheckCanonicalLink(XmlNode& model, bool is_strict, Diagnostics& diagnostics);
/// Reports joints without valid links, and duplicate names: libsdformat's messages have no line numbers.
void CheckNames(const XmlNode& model, Diagnostics& diagnostics);

/// Splits `model` (`<model>`) into one model for each set of connected bodies. The set with the most joints
/// is first and keeps the name; the others are named MODEL_LINK. Returns `model` itself if all is connected.
std::vector<XmlNode> SplitLoose(const XmlNode& model);

/// Translates a URDF `robot` (`<robot>`) into SDF. Reports unusable parts.
XmlNode SdfOfUrdf(const XmlNode& robot, Diagnostics& diagnostics);

/// Adapts `model` (`<model>`) to coopdyn: replaces Gazebo's plugins by coopdyn elements and removes unused
/// elements, reporting each kind once. `resources`: for files that plugins name; may be null.
void AdoptModel(XmlNode& model, const Resources* resources, Diagnostics& diagnostics);

/// True if an unused element states what coopdyn does anyway, such as <gravity>true</gravity>.
bool IsAsHere(const XmlNode& node);

/// "r g b a" of a single-colour Gazebo material such as Gazebo/Red; nullopt for others.
std::optional<std::string> GazeboColor(const std::string& material);

/// Appends diagnostics found in a composed text, moved to the lines of the original files.
void AppendMapped(const Diagnostics& found, const std::string& file, const ModelSource& source,
                  Diagnostics& diagnostics);

}  // namespace coopdyn
