// SPDX-License-Identifier: MIT
// A model's text in one piece, before libsdformat reads it: URDF written as SDF, older SDF as the newest,
// what <include> names written out, meshes loaded, what only Gazebo understands translated or reported. One
// thread.
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
  std::string text;               // SDF 1.9; without the data of its meshes
  std::vector<SourceLine> lines;  // where each line of `text` was written; empty: in `text` itself
  MeshTable meshes;
  /// Made for other programs: what cannot be used is left out with a warning, and defaults fill the gaps.
  bool foreign = false;
  bool in_world = false;  // a world says where it stands, so its origin stays (coopdyn:in_world)
  std::filesystem::path parts_folder{};  // where parts of meshes are kept (kept_parts.h)
  bool lifts = false;                    // what reaches below the floor is put on it (coopdyn:lift)
};

/// `resources`: null for a text that came without files. Nothing if the text is hopeless (then reported).
std::optional<ModelSource> ComposeModel(const std::string& text, const std::string& file,
                                        const Resources* resources, Diagnostics& diagnostics);

/// The same of the SDF `root` that has one <model>; source.foreign is given.
void ComposeTree(XmlNode root, const Resources* resources, ModelSource& source, Diagnostics& diagnostics);

/// Whether `node` or what is in it has elements of ours; elements called `name`.
bool HasOwnElements(const XmlNode& node);
bool HasAny(const XmlNode& node, std::string_view name);

/// As how many convex parts a mesh collides at most: an attribute of a composed <mesh>, from SDF's
/// `optimization`.
inline constexpr const char* kPartsAttribute = "coopdyn:parts";
inline constexpr int kMostWantedParts = 64;

/// Of a composed <inertial>: the link has the masses of its collisions, each of which has its density as an
/// attribute, and those that become meshes the volume, the moments for 1 kg, and the z of the centre of mass
/// of the solid that they stand for.
inline constexpr const char* kWeighAttribute = "coopdyn:weigh";
inline constexpr const char* kDensityAttribute = "coopdyn:density";
inline constexpr const char* kSolidAttribute = "coopdyn:solid_of";

/// Loads the meshes, heightmaps and textures that `root` names; each is then a mesh called mesh:1, mesh:2, …
void LoadMeshes(XmlNode& root, const Resources* resources, MeshTable& table, Diagnostics& diagnostics);

/// Writes the `<ellipsoid>`s and `<cone>`s in `model` as meshes; a link whose first shape is one and that has
/// a mass and no <inertia> gets that of the solid.
void MakeRoundMeshes(XmlNode& model, MeshTable& table, Diagnostics& diagnostics);

/// The text that a recording keeps: read again without files, it gives the same model.
std::string WithMeshes(const ModelSource& source);

/// The models of `root` (`<world>` or `<sdf>`), with what it includes written out. Of what a world of other
/// programs includes and is not there, only a warning is left, unless that is all of it.
void ExpandIncludes(XmlNode& root, const Resources* resources, Diagnostics& diagnostics);
/// The parts of `model` (`<model>`, with the <pose> of its <include>) as those of a model that merges it.
std::vector<XmlNode> PartsToMerge(XmlNode model);
/// Makes the <pose> of `model` (`<model>`, whose includes are written out) that of its own frame instead of
/// its placement_frame. One that names nothing is a warning.
void SettlePlacement(XmlNode& model, Diagnostics& diagnostics);
/// What `<pose>` says, also in degrees or as a quaternion; nothing for null.
Pose PoseOf(const XmlNode* pose);
/// Joints of models in `model` that name its own links become its joints: Gazebo Classic takes them so.
void RaiseJoints(XmlNode& model, Diagnostics& diagnostics);
/// Minor number of an SDF version 1.x; nothing for anything else.
std::optional<int> MinorOf(const std::string& version);
/// Writes elements of older and newer SDF as those of 1.9. `version`: of the file of `root`.
void Upgrade(XmlNode& root, const std::string& version);

/// Writes what libsdformat does not know of the joints of `model` (`<model>`) in other words: a `<mimic>` as
/// a `<coopdyn:mimic>` of the model, `<screw_thread_pitch>` as the older `<thread_pitch>`. `is_foreign`:
/// joints that follow fixed ones become fixed, which is said.
void GatherMimics(XmlNode& model, bool is_foreign, Diagnostics& diagnostics);

/// Writes joints of several axes in `model` (`<model>`) as chains of joints with one axis each:
/// `<coopdyn:six_axis>`, and SDF's revolute2. Between them stand links without shapes (`coopdyn:carrier`).
void ExpandChains(XmlNode& model, Diagnostics& diagnostics);
bool HasChains(const XmlNode& node);

/// Gives what libsdformat refuses other names: joints that are called like a link or `world` (`coopdyn:name`
/// has what they are called), and shapes of one name in a link. A link `world` is the world itself.
void FreeNames(XmlNode& model, Diagnostics& diagnostics);
/// Gives a sensor that is called like another of its link or joint a name of its own, and says so.
void NumberSensors(XmlNode& model, Diagnostics& diagnostics);
/// Makes fixed ones of joints whose axis has no direction and whose limits are both 0: so some models hold
/// sensors of forces.
void FixStillJoints(XmlNode& model, Diagnostics& diagnostics);
/// Takes canonical_link from models in which it names no link: mended, or an error.
void CheckCanonicalLink(XmlNode& model, bool is_strict, Diagnostics& diagnostics);
/// Reports joints that join no links, and names that two have: libsdformat's words have no lines.
void CheckNames(const XmlNode& model, Diagnostics& diagnostics);

/// `model` (`<model>`) as one model for each body that no joint holds to another: the one with the most
/// joints first, by its own name, the others called MODEL_LINK. `model` itself if it hangs together.
std::vector<XmlNode> SplitLoose(const XmlNode& model);

/// The SDF of a URDF `robot` (`<robot>`). Reports what it cannot use.
XmlNode SdfOfUrdf(const XmlNode& robot, Diagnostics& diagnostics);

/// Makes `model` (`<model>`) one that coopdyn reads: Gazebo's plug-ins become our elements, and the rest that
/// is not used is left out, each said once. `resources`: where the files are that plug-ins name; may be null.
void AdoptModel(XmlNode& model, const Resources* resources, Diagnostics& diagnostics);

/// Whether an element that is not used says what is so anyway, as that a link falls.
bool IsAsHere(const XmlNode& node);

/// The "r g b a" of a material of Gazebo's that is one colour, as Gazebo/Red; nothing for any other.
std::optional<std::string> GazeboColor(const std::string& material);

/// Moves what was found at lines of a composed text to where they were written.
void AppendMapped(const Diagnostics& found, const std::string& file, const ModelSource& source,
                  Diagnostics& diagnostics);

}  // namespace coopdyn
