// SPDX-License-Identifier: MIT
// Answers given at once, from the last published frame. UI thread.
#pragma once

#include <string>

#include "server/web/http_routes.h"
#include "server/web/web_context.h"

namespace coopdyn {

/// `what`: scenarios, worlds or robots.
HttpAnswer AnswerNames(const WebContext& context, const std::string& what);
HttpAnswer AnswerModules(const WebContext& context);
/// 503 before a world is loaded, like AnswerText().
HttpAnswer AnswerScene(WebContext& context);
HttpAnswer AnswerText(const WebContext& context);
/// 404 if the daemon does not measure costs.
HttpAnswer AnswerCosts(WebContext& context);
/// `name`: the mesh's hexadecimal id, from /api/scene; 404 if unknown.
HttpAnswer AnswerMesh(const WebContext& context, const std::string& name);
/// `name`: a texture of the scene; 404 if unknown.
HttpAnswer AnswerTexture(const WebContext& context, const std::string& name);

}  // namespace coopdyn
