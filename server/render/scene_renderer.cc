// SPDX-License-Identifier: MIT
#include "server/render/scene_renderer.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "server/render/gl_mesh.h"
#include "server/render/gl_objects.h"
#include "server/render/label_painter.h"
#include "server/render/lit_programs.h"
#include "server/render/shaders.h"

namespace coopdyn {

namespace {

// A square of ±1 for the floor, and a triangle that covers the picture for the sky.
constexpr float kFloorCorners[] = {-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, -1, 0, 1, 1, 0, -1, 1, 0};
constexpr unsigned char kWhite[] = {255, 255, 255};
constexpr float kSkyCorners[] = {-1, -1, 0, 3, -1, 0, -1, 3, 0};

// The uniform `roundness` of the number shader.
int RoundnessOf(MeshId id) {
  return id == MeshId::kBox ? 0 : id < MeshId::kSphere8 ? 1 : 2;
}

// The slab under the floor, visible at its edge; its top lies slightly below the drawn floor.
DrawList Slab(const Floor& floor) {
  constexpr double kGap_m = 0.002, kMaxHeight_m = 0.1;
  DrawList list;
  const double height_m = std::min(floor.height_m, kMaxHeight_m) - kGap_m;
  if (height_m <= 0) return list;
  const auto f = [](double x) { return static_cast<float>(x); };
  list.meshes[static_cast<std::size_t>(MeshId::kBox)].push_back(
      {{1, 0, 0, 0, 1, 0, 0, 0, 1},
       {f(floor.length_m), f(floor.width_m), f(height_m)},
       {0, 0, f(-kGap_m - height_m / 2)},
       {f(0.8 * floor.color.r), f(0.8 * floor.color.g), f(0.8 * floor.color.b)}});
  return list;
}

}  // namespace

struct SceneRenderer::Impl {
  Impl(const GlApi& gl_api, std::string& error)
      : gl(gl_api),
        lit(std::make_unique<LitPrograms>(gl, 0, error)),
        shadow(gl, Source(shaders::kMeshVertex), Source(shaders::kShadowFragment), error),
        sky(gl, Source(shaders::kSkyVertex), Source(shaders::kSkyFragment), error),
        overlay(gl, Source(shaders::kOverlayVertex), Source(shaders::kOverlayFragment), error),
        number(gl, Source(shaders::kMeshVertex, "#define ROUND\n"), Source(shaders::kNumberFragment), error),
        floor_number(gl, Source(shaders::kFloorVertex), Source(shaders::kFloorNumberFragment), error),
        mesh_vertices(gl),
        mesh_indices(gl),
        instances(gl),
        floor_vertices(gl),
        sky_vertices(gl),
        overlay_vertices(gl),
        white(gl, 1, 1, kWhite) {
    const Meshes meshes = MakeMeshes();
    ranges = meshes.ranges;
    mesh_vertices.Bind();
    mesh_vertices.Upload(meshes.vertices.data(), meshes.vertices.size() * sizeof(MeshVertex), GL_STATIC_DRAW);
    mesh_vertices.Attribute(0, 3, sizeof(MeshVertex), offsetof(MeshVertex, position));
    mesh_vertices.Attribute(1, 3, sizeof(MeshVertex), offsetof(MeshVertex, normal));
    gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, mesh_indices.buffer());
    gl.BufferData(GL_ELEMENT_ARRAY_BUFFER,
                  static_cast<GLsizeiptr>(meshes.indices.size() * sizeof(std::uint16_t)),
                  meshes.indices.data(), GL_STATIC_DRAW);
    floor_vertices.Bind();
    floor_vertices.Upload(kFloorCorners, sizeof(kFloorCorners), GL_STATIC_DRAW);
    floor_vertices.Attribute(0, 3, 3 * sizeof(float), 0);
    sky_vertices.Bind();
    sky_vertices.Upload(kSkyCorners, sizeof(kSkyCorners), GL_STATIC_DRAW);
    sky_vertices.Attribute(0, 3, 3 * sizeof(float), 0);
    overlay_vertices.Bind();
    overlay_vertices.Attribute(0, 4, sizeof(OverlayVertex), offsetof(OverlayVertex, clip));
    overlay_vertices.Attribute(1, 2, sizeof(OverlayVertex), offsetof(OverlayVertex, uv));
    overlay_vertices.Attribute(2, 4, sizeof(OverlayVertex), offsetof(OverlayVertex, color));
    overlay_vertices.Attribute(3, 1, sizeof(OverlayVertex), offsetof(OverlayVertex, kind));
  }

  void SetVector(const GlProgram& program, const char* name, const Vector3& v) const {
    gl.Uniform3f(program.Uniform(name), static_cast<float>(v.x()), static_cast<float>(v.y()),
                 static_cast<float>(v.z()));
  }
  void Use(const GlProgram& program, const Eigen::Matrix4f& clip_from_W) const {
    gl.UseProgram(program.id());
    gl.UniformMatrix4fv(program.Uniform("clip_from_world"), 1, GL_FALSE, clip_from_W.data());
    SetVector(program, "sun", SunDirection().normalized());
  }

  /// Makes the programs for the number of lamps in `scene`.
  void FitLamps(const Scene& scene) {
    if (lit->lamps == LampsOf(scene)) return;
    std::string error;
    auto made = std::make_unique<LitPrograms>(gl, LampsOf(scene), error);
    if (error.empty()) lit = std::move(made);
  }

  /// Like Use(), and sets the lamps of `scene`; if there are too many, those nearest to the camera.
  void UseLit(const GlProgram& program, const Eigen::Matrix4f& clip_from_W, const Scene& scene,
              const Camera& camera) const {
    Use(program, clip_from_W);
    SetVector(program, "eye", camera.eye_W);
    if (lit->lamps == 0) return;
    std::vector<const PointLight*> lamps;
    for (const PointLight& lamp : scene.lights) lamps.push_back(&lamp);
    std::ranges::stable_sort(
        lamps, {}, [&](const PointLight* lamp) { return (lamp->p_WP - camera.eye_W).squaredNorm(); });
    lamps.resize(std::min(lamps.size(), lit->lamps));
    std::vector<float> places, lights;
    for (const PointLight* lamp : lamps) {
      const Vector3 light = lamp->power * Vector3(lamp->color.r, lamp->color.g, lamp->color.b);
      for (const double x : lamp->p_WP) places.push_back(static_cast<float>(x));
      for (const double x : light) lights.push_back(static_cast<float>(x));
    }
    const auto count = static_cast<GLsizei>(lamps.size());
    gl.Uniform3fv(program.Uniform("lamp_place"), count, places.data());
    gl.Uniform3fv(program.Uniform("lamp_light"), count, lights.data());
  }

  void SetTexture(const GlProgram& program, const Texture& texture) {
    const bool is_there = texture.image != nullptr;
    gl.Uniform2f(program.Uniform("picture_size"), is_there ? static_cast<float>(texture.width_m) : 0,
                 is_there ? static_cast<float>(texture.height_m) : 0);
    BindTexture(texture.image);
  }

  // Draws all shapes of `list` with the program in use.
  void DrawInstances(const DrawList& list) const { DrawInstances(list.meshes); }
  // `rounded`: the program in use if it has a uniform `roundness`, else null.
  void DrawInstances(const std::array<std::vector<MeshInstance>, kMeshCount>& meshes,
                     const GlProgram* rounded = nullptr) const {
    mesh_vertices.Bind();
    for (std::size_t id = 0; id < kMeshCount; ++id) {
      if (meshes[id].empty()) continue;
      if (rounded != nullptr)
        gl.Uniform1i(rounded->Uniform("roundness"), RoundnessOf(static_cast<MeshId>(id)));
      instances.Upload(meshes[id].data(), meshes[id].size() * sizeof(MeshInstance), GL_STREAM_DRAW);
      // Attributes 2…7 are triples of floats, in the order of MeshInstance.
      for (GLuint i = 0; i < 6; ++i)
        instances.Attribute(2 + i, 3, sizeof(MeshInstance), 3 * i * sizeof(float), 1);
      gl.DrawElementsInstanced(GL_TRIANGLES, static_cast<GLsizei>(ranges[id].count), GL_UNSIGNED_SHORT,
                               reinterpret_cast<const void*>(ranges[id].first_index * sizeof(std::uint16_t)),
                               static_cast<GLsizei>(meshes[id].size()));
    }
  }
  // Binds a mesh and its instances. Once drawn, the mesh stays in the driver's memory.
  const GlMesh& BindMesh(const MeshDraw& draw) {
    auto& made = model_meshes[draw.mesh->id];
    if (made == nullptr) made = std::make_unique<GlMesh>(gl, *draw.mesh);
    made->vertices.Bind();
    instances.Upload(draw.instances.data(), draw.instances.size() * sizeof(MeshInstance), GL_STREAM_DRAW);
    for (GLuint i = 0; i < 6; ++i)
      instances.Attribute(2 + i, 3, sizeof(MeshInstance), 3 * i * sizeof(float), 1);
    return *made;
  }
  // Draws the meshes of models in the colours of their instances.
  void DrawModelMeshes(const DrawList& list, bool also_skins) {
    gl.Disable(GL_CULL_FACE);  // files may not define the outside of faces
    for (const MeshDraw& draw : list.model_meshes) {
      if (draw.in_skin && !also_skins) continue;
      gl.DrawElementsInstanced(GL_TRIANGLES, BindMesh(draw).count, GL_UNSIGNED_INT, nullptr,
                               static_cast<GLsizei>(draw.instances.size()));
    }
  }
  // Draws the meshes that have their own materials.
  void DrawSkins(const DrawList& list) {
    for (const MeshDraw& draw : list.model_meshes) {
      if (!draw.in_skin) continue;
      for (const GlMesh::Range& range : BindMesh(draw).ranges) {
        const MeshSkin::Material& material = draw.mesh->skin->materials[range.material];
        const auto& tint = material.texture != nullptr ? material.tint : material.color;
        SetVector(lit->skin, "tint", {tint[0], tint[1], tint[2]});
        BindTexture(material.texture);
        gl.DrawElementsInstanced(GL_TRIANGLES, range.count, GL_UNSIGNED_INT,
                                 reinterpret_cast<const void*>(range.first * sizeof(std::uint32_t)),
                                 static_cast<GLsizei>(draw.instances.size()));
      }
    }
  }
  void BindTexture(const std::shared_ptr<const Image>& image) {
    if (image == nullptr) return white.Bind();
    auto& [held, made] = textures[image.get()];
    if (made == nullptr) {
      held = image;
      made = std::make_unique<GlTexture>(gl, image->width, image->height, image->rgb.data());
    }
    made->Bind();
  }
  void DrawOverlay(const std::vector<OverlayVertex>& vertices) const {
    if (vertices.empty()) return;
    gl.UseProgram(overlay.id());
    overlay_vertices.Bind();
    overlay_vertices.Upload(vertices.data(), vertices.size() * sizeof(OverlayVertex), GL_STREAM_DRAW);
    gl.DrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(vertices.size()));
  }

  void DrawSky(const Camera& camera, int width, int height) const {
    const Matrix3 axes = ViewMatrix(camera).topLeftCorner<3, 3>();
    const double tan_y = std::tan(camera.fov_rad / 2);
    gl.UseProgram(sky.id());
    SetVector(sky, "right", axes.row(0).transpose() * (tan_y * width / height));
    SetVector(sky, "up", axes.row(1).transpose() * tan_y);
    SetVector(sky, "forward", -axes.row(2).transpose());
    sky_vertices.Bind();
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
  }

  // Clears the target and prepares for solid shapes; returns the matrix from world to clip coordinates.
  Eigen::Matrix4f Begin(const Camera& camera, int width, int height) {
    gl.Viewport(0, 0, width, height);
    gl.Enable(GL_DEPTH_TEST);
    gl.Enable(GL_CULL_FACE);
    gl.DepthMask(GL_TRUE);
    gl.DepthFunc(GL_LEQUAL);
    gl.Disable(GL_BLEND);
    gl.Disable(GL_STENCIL_TEST);
    gl.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT | GL_STENCIL_BUFFER_BIT);
    return (ProjectionMatrix(camera, width, height) * ViewMatrix(camera)).cast<float>();
  }

  void DrawScene(const DrawList& list, const Scene& scene, const Camera& camera, int width, int height) {
    const Floor& floor_model = scene.floor;
    const Eigen::Matrix4f clip_from_W = Begin(camera, width, height);
    FitLamps(scene);

    // Draw shapes first: the floor behind them need not be shaded.
    UseLit(lit->mesh, clip_from_W, scene, camera);
    SetVector(lit->mesh, "shadow_along", Vector3::Zero());
    DrawInstances(Slab(floor_model));
    DrawInstances(list);
    DrawModelMeshes(list, false);
    UseLit(lit->skin, clip_from_W, scene, camera);
    SetVector(lit->skin, "shadow_along", Vector3::Zero());
    DrawSkins(list);
    gl.Enable(GL_CULL_FACE);
    if (!list.clad.empty()) {
      UseLit(lit->clad, clip_from_W, scene, camera);
      SetVector(lit->clad, "shadow_along", Vector3::Zero());
      for (const CladDraw& draw : list.clad) {
        SetTexture(lit->clad, draw.texture);
        DrawInstances(draw.meshes);
      }
    }

    // Visible floor pixels get 1 in the stencil and shadowed ones 2, so that shadows do not add up.
    gl.Enable(GL_STENCIL_TEST);
    gl.StencilFunc(GL_ALWAYS, 1, 0xff);
    gl.StencilOp(GL_KEEP, GL_KEEP, GL_REPLACE);
    UseLit(lit->floor, clip_from_W, scene, camera);
    SetTexture(lit->floor, floor_model.texture);
    SetVector(lit->floor, "half_size", {floor_model.length_m / 2, floor_model.width_m / 2, 1});
    SetVector(lit->floor, "floor_color", {floor_model.color.r, floor_model.color.g, floor_model.color.b});
    floor_vertices.Bind();
    gl.DrawArrays(GL_TRIANGLES, 0, 6);

    gl.Disable(GL_CULL_FACE);
    gl.Disable(GL_DEPTH_TEST);
    gl.Enable(GL_BLEND);
    gl.BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    gl.StencilFunc(GL_EQUAL, 1, 0xff);
    gl.StencilOp(GL_KEEP, GL_KEEP, GL_INCR);
    Use(shadow, clip_from_W);
    SetVector(shadow, "shadow_along", SunDirection());
    DrawInstances(list);
    for (const CladDraw& draw : list.clad) DrawInstances(draw.meshes);
    DrawModelMeshes(list, true);

    gl.StencilFunc(GL_LEQUAL, 1, 0xff);
    gl.StencilOp(GL_KEEP, GL_KEEP, GL_KEEP);
    DrawOverlay(list.floor_marks);

    gl.Disable(GL_STENCIL_TEST);
    gl.Disable(GL_BLEND);
    gl.Enable(GL_DEPTH_TEST);
    DrawSky(camera, width, height);

    gl.Enable(GL_BLEND);
    gl.DepthMask(GL_FALSE);
    DrawOverlay(list.sensor_marks);
    gl.Disable(GL_DEPTH_TEST);
    DrawOverlay(list.joint_marks);
    gl.Enable(GL_DEPTH_TEST);
    gl.DepthMask(GL_TRUE);
  }

  // Draws depths and numbers; `list` has numbers as colours.
  void DrawNumbers(const DrawList& list, const Floor& floor_model, const Camera& camera, int width,
                   int height) {
    const Eigen::Matrix4f clip_from_W = Begin(camera, width, height);
    const Vector3 forward = -ViewMatrix(camera).block<1, 3>(2, 0).transpose();
    Use(number, clip_from_W);
    SetVector(number, "eye", camera.eye_W);
    SetVector(number, "forward", forward);
    SetVector(number, "shadow_along", Vector3::Zero());
    DrawList slab = Slab(floor_model);
    for (auto& instances_of : slab.meshes) {
      for (MeshInstance& instance : instances_of) instance.color = {kFloorNumber, 0, 0};
    }
    DrawInstances(slab.meshes, &number);
    DrawInstances(list.meshes, &number);
    gl.Uniform1i(number.Uniform("roundness"), 0);
    DrawModelMeshes(list, true);
    gl.Enable(GL_CULL_FACE);
    Use(floor_number, clip_from_W);
    SetVector(floor_number, "eye", camera.eye_W);
    SetVector(floor_number, "forward", forward);
    SetVector(floor_number, "half_size", {floor_model.length_m / 2, floor_model.width_m / 2, 1});
    floor_vertices.Bind();
    gl.DrawArrays(GL_TRIANGLES, 0, 6);
  }

  const GlApi& gl;
  std::unique_ptr<LitPrograms> lit;  // for the number of lamps in the last drawn scene
  GlProgram shadow, sky, overlay, number, floor_number;
  GlVertices mesh_vertices, mesh_indices, instances, floor_vertices, sky_vertices, overlay_vertices;
  GlTexture white;  // for materials without a texture
  // Keeps each image alive as long as its texture, so that its address is not reused.
  std::map<const Image*, std::pair<std::shared_ptr<const Image>, std::unique_ptr<GlTexture>>> textures;
  std::array<MeshRange, kMeshCount> ranges{};
  std::map<std::uint64_t, std::unique_ptr<GlMesh>> model_meshes;  // by MeshData::id
  // Targets of the last used sizes, most recently used last.
  std::vector<std::unique_ptr<GlTarget>> targets;
  std::vector<std::unique_ptr<GlNumbers>> number_targets;
  LabelPainter labels;
};

SceneRenderer::SceneRenderer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
SceneRenderer::~SceneRenderer() = default;

std::unique_ptr<SceneRenderer> SceneRenderer::Create(const GlContext& context, std::string& error) {
  auto impl = std::make_unique<Impl>(context.gl(), error);
  if (!error.empty()) return nullptr;
  return std::unique_ptr<SceneRenderer>(new SceneRenderer(std::move(impl)));
}

namespace {

/// The target that `fits`, else a new one from `make()`. Moves it to the end.
template <typename Target, typename Fits, typename Make>
const Target& TargetOf(std::vector<std::unique_ptr<Target>>& targets, Fits fits, Make make) {
  constexpr std::size_t kMost = 6;  // enough for several camera sizes and the view
  const auto found = std::ranges::find_if(targets, [&](const auto& target) { return fits(*target); });
  if (found != targets.end()) {
    std::rotate(found, found + 1, targets.end());
  } else {
    if (targets.size() >= kMost) targets.erase(targets.begin());
    targets.push_back(make());
  }
  return *targets.back();
}

}  // namespace

SceneRenderer::Numbers SceneRenderer::DrawNumbers(const Frame& frame, const ImageRequest& request,
                                                  const Camera& camera) {
  const int width = request.width, height = request.height;
  const GlNumbers& target = TargetOf(
      impl_->number_targets,
      [&](const GlNumbers& one) { return one.width() == width && one.height() == height; },
      [&] { return std::make_unique<GlNumbers>(impl_->gl, width, height); });
  if (!target.complete()) return {};
  target.Bind();
  impl_->DrawNumbers(MakeDrawList(frame, request, camera, Paint::kNumbers), frame.scene->floor, camera, width,
                     height);
  const auto columns = static_cast<std::size_t>(width), rows = static_cast<std::size_t>(height);
  std::vector<float> upside_down(2 * columns * rows);
  target.Read(upside_down.data());
  Numbers numbers;
  numbers.depth_m.resize(columns * rows);
  numbers.numbers.resize(columns * rows);
  for (std::size_t y = 0; y < rows; ++y) {
    const float* from = upside_down.data() + 2 * (rows - 1 - y) * columns;
    for (std::size_t x = 0; x < columns; ++x) {
      const auto number = static_cast<std::uint16_t>(from[2 * x + 1]);
      numbers.numbers[y * columns + x] = number;
      numbers.depth_m[y * columns + x] = number == 0 ? std::numeric_limits<float>::infinity() : from[2 * x];
    }
  }
  return numbers;
}

Picture SceneRenderer::Draw(const Frame& frame, const ImageRequest& request, const Camera& camera) {
  const int width = request.width, height = request.height;
  const int samples = request.shot ? 0 : 4;  // robots' cameras must be fast
  const GlTarget* const target = &TargetOf(
      impl_->targets,
      [&](const GlTarget& one) {
        return one.width() == width && one.height() == height && one.samples() == samples;
      },
      [&] { return std::make_unique<GlTarget>(impl_->gl, width, height, samples); });
  Picture picture{width, height, {}};
  if (!target->complete()) return {};
  target->Bind();
  const DrawList list = MakeDrawList(frame, request, camera);
  impl_->DrawScene(list, *frame.scene, camera, width, height);

  std::vector<std::uint8_t> upside_down(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                                        3);
  target->Read(upside_down.data());
  picture.rgb.resize(upside_down.size());
  const auto row = static_cast<std::size_t>(width) * 3;
  for (std::size_t y = 0; y < static_cast<std::size_t>(height); ++y) {
    std::memcpy(picture.rgb.data() + y * row,
                upside_down.data() + (static_cast<std::size_t>(height) - 1 - y) * row, row);
  }
  impl_->labels.Paint(picture, list.labels);
  return picture;
}

}  // namespace coopdyn
