// SPDX-License-Identifier: MIT
// Answers that a connection gives at once, from what the world last published. UI thread.
#pragma once

#include <string>

#include "server/web/http_routes.h"
#include "server/web/web_context.h"

namespace coopdyn {

/// `what`: scenarios, worlds or robots.
HttpAnswer AnswerNames(const WebContext& context, const std::string& what);
HttpAnswer AnswerModules(const WebContext& context);
/// 503 before there is a world; so does AnswerText().
HttpAnswer AnswerScene(WebContext& context);
HttpAnswer AnswerText(const WebContext& context);
/// 404 from a daemon that does not measure.
HttpAnswer AnswerCosts(WebContext& context);
/// `name`: the mesh's id as /api/scene writes it, hexadecimal; 404 for an unknown one.
HttpAnswer AnswerMesh(const WebContext& context, const std::string& name);
/// `name`: a texture of the scene; 404 for an unknown one.
HttpAnswer AnswerTexture(const WebContext& context, const std::string& name);

}  // namespace coopdyn
