// SPDX-License-Identifier: MIT
#include "server/web/direct_answers.h"

#include <boost/json.hpp>
#include <charconv>
#include <utility>
#include <vector>

#include "protocol/json_text.h"
#include "server/web/mesh_glb.h"
#include "server/web/scene_json.h"

namespace coopdyn {

namespace json = boost::json;

/// ["classroom","corridor"]
HttpAnswer AnswerNames(const WebContext& context, const std::string& what) {
  const auto names = context.options.names ? context.options.names(what) : std::vector<std::string>();
  return JsonAnswer(JsonText(json::value_from(names)));
}

/// {"name_port":10000,"version":"0.1.0","modules":[{"name":"/robot1/motors","address":null,"port":10002,"external":false}]};
/// A null `address` means the address of the page.
HttpAnswer AnswerModules(const WebContext& context) {
  json::array modules;
  for (const NameEntry& entry : context.names.List()) {
    if (entry.kind == NameKind::kAlias) continue;
    modules.push_back({{"name", entry.name},
                       {"address", entry.ip.empty() ? json::value(nullptr) : json::value(entry.ip)},
                       {"port", entry.port},
                       {"external", entry.external}});
  }
  return JsonAnswer(JsonText(json::object{{"name_port", context.options.name_port},
                                          {"version", context.options.version},
                                          {"modules", std::move(modules)}}));
}

HttpAnswer AnswerScene(WebContext& context) {
  const FramePtr frame = context.frames.Latest();
  if (frame == nullptr) return ErrorAnswer(503, "no world is loaded yet: retry in a second");
  return JsonAnswer(SceneJson(*frame, context.scenes.Of(frame->scene)));
}

/// The text of the scenario as loaded.
HttpAnswer AnswerText(const WebContext& context) {
  const FramePtr frame = context.frames.Latest();
  if (frame == nullptr) return ErrorAnswer(503, "no world is loaded yet: retry in a second");
  return {.body = frame->scene->scenario->text, .headers = {{"Cache-Control", "no-store"}}};
}

HttpAnswer AnswerCosts(WebContext& context) {
  if (!context.options.costs) return ErrorAnswer(404, "this daemon does not measure what steps cost");
  return JsonAnswer(context.costs.Json(context.options.costs()));
}

HttpAnswer AnswerMesh(const WebContext& context, const std::string& name) {
  const FramePtr frame = context.frames.Latest();
  std::uint64_t id = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), id, 16);
  const bool read = error == std::errc() && end == name.data() + name.size();
  std::string glb = frame != nullptr && read ? MeshGlb(*frame->scene, id) : "";
  if (glb.empty()) return ErrorAnswer(404, "no robot in the scene has this mesh: /api/scene lists them");
  // The name identifies the content, so it may be cached.
  return {
      .body = std::move(glb), .type = "model/gltf-binary", .headers = {{"Cache-Control", "max-age=86400"}}};
}

HttpAnswer AnswerTexture(const WebContext& context, const std::string& name) {
  const FramePtr frame = context.frames.Latest();
  const auto image = frame == nullptr ? nullptr : FindTextureImage(*frame->scene, name);
  if (image == nullptr)
    return ErrorAnswer(404, "nothing in the scene has this texture: /api/scene lists them");
  return {.body = BitmapOf(*image), .type = "image/bmp", .headers = {{"Cache-Control", "no-cache"}}};
}

}  // namespace coopdyn
