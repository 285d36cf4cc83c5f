// SPDX-License-Identifier: MIT
#include "server/web/scene_json.h"

#include <algorithm>
#include <bit>
#include <boost/json.hpp>
#include <cstring>
#include <map>
#include <utility>
#include <vector>

#include "protocol/json_text.h"
#include "server/geometry/mesh.h"
#include "server/state/world_change.h"
#include "server/web/mesh_glb.h"

namespace coopdyn {

namespace {

namespace json = boost::json;

/// Rounds to the digits that a picture needs.
double Short(double value) {
  constexpr double kUnit = 1e-5;
  return std::abs(value) < 1e9 ? std::round(value / kUnit) * kUnit : value;
}

json::array Numbers(const Vector3& v) {
  return {Short(v.x()), Short(v.y()), Short(v.z())};
}
json::array Numbers(const Quaternion& q) {  // in the order of three.js
  return {Short(q.x()), Short(q.y()), Short(q.z()), Short(q.w())};
}
json::array Numbers(const Color& color) {
  return {Short(color.r), Short(color.g), Short(color.b)};
}

/// Adds the `type` and `size` (or `mesh`) of a shape of this colour.
void AddShape(json::object& to, const Shape& shape, const Color& color) {
  if (const auto* box = std::get_if<Box>(&shape)) {
    to["type"] = "box";
    to["size"] = Numbers(box->size_m);
  } else if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
    to["type"] = "cylinder";
    to["size"] = json::array{Short(cylinder->radius_m), Short(cylinder->length_m)};
  } else if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    to["type"] = "sphere";
    to["size"] = json::array{Short(sphere->radius_m)};
  } else if (const auto* capsule = std::get_if<Capsule>(&shape)) {
    to["type"] = "capsule";
    to["size"] = json::array{Short(capsule->radius_m), Short(capsule->length_m)};
  } else {
    const MeshData& mesh = *std::get<Mesh>(shape).data;
    to["type"] = "mesh";
    to["mesh"] = HashText(mesh.id);
    if (mesh.skin != nullptr) to["skin"] = mesh.color == std::array<double, 3>{color.r, color.g, color.b};
  }
}

/// The names by which a page asks for textures: a further picture of the same name (a checker in another
/// colour, a file of another folder) is NAME#2, in the order of the floor and the things.
class TextureNames {
 public:
  std::string Of(const Texture& texture) {
    std::vector<std::shared_ptr<const Image>>& images = images_[texture.name];
    const auto same = std::ranges::find_if(images, [&texture](const auto& image) {
      return image == texture.image ||
             (image->width == texture.image->width && image->height == texture.image->height &&
              image->rgb == texture.image->rgb);
    });
    const auto number = same - images.begin() + 1;
    if (same == images.end()) images.push_back(texture.image);
    return number == 1 ? texture.name : texture.name + "#" + std::to_string(number);
  }

 private:
  std::map<std::string, std::vector<std::shared_ptr<const Image>>> images_;
};

json::value TextureJson(const Texture& texture, TextureNames& names) {
  if (texture.image == nullptr) return nullptr;
  return json::object{{"name", names.Of(texture)},
                      {"size", {Short(texture.width_m), Short(texture.height_m)}}};
}

/// The pose of `link` in the body with which it is drawn.
Pose LinkInBody(const SceneRobot& robot, const LinkModel& link) {
  if (!robot.one_body()) return link.X_LI.Inverse();
  return robot.X_BR * link.X_RL;
}

json::object ModelJson(const SceneRobot& robot) {
  const RobotModel& model = *robot.entry.model;
  json::array shapes;
  for (std::size_t k = 0; k < model.links.size(); ++k) {
    const LinkModel& link = model.links[k];
    const bool has_visuals = !link.visuals.empty();
    for (const LinkShape& shape : has_visuals ? link.visuals : link.collisions) {
      const Pose X_BG = LinkInBody(robot, link) * shape.X_LG;
      json::object one{
          {"body", robot.one_body() ? 0 : static_cast<int>(k)},
          {"position", Numbers(X_BG.p)},
          {"quaternion", Numbers(X_BG.q)},
          {"color", shape.takes_robot_color ? json::value(nullptr) : json::value(Numbers(shape.color))}};
      AddShape(one, shape.shape, shape.color);
      shapes.push_back(std::move(one));
    }
  }
  json::array joints;
  for (const JointModel& joint : model.joints) {
    if (!joint.joins()) continue;
    const LinkModel& child = model.links[static_cast<std::size_t>(joint.child)];
    const Pose X_RB = child.X_RL * child.X_LI;
    const Vector3 p_B = X_RB.q.conjugate() * (joint.p_RJ - X_RB.p);
    joints.push_back(
        {{"name", joint.name},
         {"body", robot.one_body() ? 0 : joint.child},
         {"position", Numbers(robot.one_body() ? robot.X_BR * joint.p_RJ : p_B)},
         {"axis", Numbers(Vector3((robot.one_body() ? robot.X_BR.q : X_RB.q.conjugate()) * joint.axis_R))}});
  }
  return {{"type", model.type},
          {"shapes", std::move(shapes)},
          {"joints", std::move(joints)},
          {"height", Short(model.height_m)},
          {"radius", Short(model.footprint_radius_m)}};
}

template <typename Number>
void Append(std::string& bytes, Number number) {
  static_assert(std::endian::native == std::endian::little);
  bytes.append(reinterpret_cast<const char*>(&number), sizeof(number));
}

json::value TaskJson(const Task& task) {
  if (task.empty()) return nullptr;
  const auto list = [](const std::vector<std::string>& texts) {
    json::array all;
    for (const std::string& text : texts) all.push_back(json::string(text));
    return all;
  };
  return json::object{
      {"title", task.title}, {"text", task.text}, {"hints", list(task.hints)}, {"counts", list(task.counts)}};
}

json::value ViewJson(const View& view) {
  if (view.look_W) return json::object{{"eye", Numbers(view.eye_W)}, {"look", Numbers(*view.look_W)}};
  return json::object{{"from", View::kWords[static_cast<std::size_t>(view.from)]}};
}

}  // namespace

std::string SceneJson(const Frame& frame, std::uint32_t number) {
  const Scene& scene = *frame.scene;
  json::array things, models, robots, targets, lights;
  TextureNames textures;
  json::value floor_texture = TextureJson(scene.floor.texture, textures);
  for (const SceneObject& thing : scene.objects) {
    const Pose X = ObjectPose(frame, thing);
    json::object one{
        {"id", thing.id.value},         {"name", thing.object.name},
        {"body", thing.body},           {"position", Numbers(X.p)},
        {"quaternion", Numbers(X.q)},   {"color", Numbers(thing.object.color)},
        {"mass", thing.object.mass_kg}, {"texture", TextureJson(thing.object.texture, textures)}};
    AddShape(one, thing.object.shape, thing.object.color);
    things.push_back(std::move(one));
  }
  std::map<std::pair<const RobotModel*, Fidelity>, std::size_t> known;
  for (std::size_t i = 0; i < scene.robots.size(); ++i) {
    const SceneRobot& robot = scene.robots[i];
    const auto [model, is_new] =
        known.emplace(std::pair(robot.entry.model.get(), robot.entry.fidelity), models.size());
    if (is_new) models.push_back(ModelJson(robot));
    robots.push_back({{"id", WorldIdOf(robot)},
                      {"name", robot.entry.name},
                      {"model", model->second},
                      {"color", Numbers(robot.entry.color)},
                      {"body", robot.first_body},
                      {"bodies", robot.body_count},
                      {"origin", Numbers(robot.X_BR.p)},
                      {"turn", Numbers(robot.X_BR.q)}});
  }
  for (const Target& target : scene.targets) {
    targets.push_back({{"id", WorldIdOf(target)},
                       {"name", TargetName(target)},
                       {"color", Numbers(target.color)},
                       {"position", Numbers(target.p_WT)}});
  }
  std::int32_t light_number = WorldId::kLights;
  for (const PointLight& light : scene.lights) {
    lights.push_back({{"id", ++light_number},
                      {"name", light.name},
                      {"color", Numbers(light.color)},
                      {"position", Numbers(light.p_WP)},
                      {"power", light.power}});
  }
  return JsonText(json::object{{"scene", number},
                               {"scenario", scene.scenario->name},
                               {"task", TaskJson(scene.scenario->task)},
                               {"view", ViewJson(scene.scenario->view)},
                               {"floor",
                                {{"size", {scene.floor.length_m, scene.floor.width_m, scene.floor.height_m}},
                                 {"color", Numbers(scene.floor.color)},
                                 {"texture", std::move(floor_texture)}}},
                               {"bodies", frame.bodies.size()},
                               {"things", std::move(things)},
                               {"models", std::move(models)},
                               {"robots", std::move(robots)},
                               {"targets", std::move(targets)},
                               {"lights", std::move(lights)}});
}

std::string BitmapOf(const Image& image) {
  constexpr std::uint32_t kHeader = 14 + 40;
  const auto width = static_cast<std::size_t>(image.width), height = static_cast<std::size_t>(image.height);
  const std::size_t row = (3 * width + 3) / 4 * 4;
  std::string bytes = "BM";
  Append(bytes, static_cast<std::uint32_t>(kHeader + row * height));
  Append(bytes, std::uint32_t{0});
  Append(bytes, kHeader);
  Append(bytes, std::uint32_t{40});
  Append(bytes, image.width);
  Append(bytes, image.height);
  Append(bytes, std::uint16_t{1});
  Append(bytes, std::uint16_t{24});
  for (int i = 0; i < 6; ++i) Append(bytes, std::uint32_t{0});
  for (std::size_t y = height; y-- > 0;) {
    const std::size_t begin = bytes.size();
    for (std::size_t x = 0; x < width; ++x) {
      const std::size_t at = 3 * (y * width + x);
      for (const std::size_t part : {2, 1, 0}) bytes += static_cast<char>(image.rgb[at + part]);
    }
    bytes.resize(begin + row, '\0');
  }
  return bytes;
}

std::shared_ptr<const Image> FindTextureImage(const Scene& scene, const std::string& name) {
  if (name.starts_with(kMeshTexture)) return MeshTexture(scene, name);
  TextureNames names;
  const auto is_it = [&](const Texture& texture) { return texture.image && names.Of(texture) == name; };
  if (is_it(scene.floor.texture)) return scene.floor.texture.image;
  for (const SceneObject& thing : scene.objects) {
    if (is_it(thing.object.texture)) return thing.object.texture.image;
  }
  return nullptr;
}

}  // namespace coopdyn
