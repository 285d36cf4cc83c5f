// SPDX-License-Identifier: MIT
// The JSON that needs no module. UI thread.
#pragma once

#include <string>

#include "server/web/http_routes.h"
#include "server/web/web_context.h"

namespace coopdyn {

HttpAnswer JsonAnswer(std::string body);
/// ["classroom","corridor"]
HttpAnswer AnswerScenarios(const WebContext& context);
/// {"name_port":10000,"version":"0.1.0","modules":[{"name":"/robot1/motors","address":null,"port":10002,"external":false}]};
/// `address` null: the one under which the page was reached.
HttpAnswer AnswerModules(const WebContext& context);

}  // namespace coopdyn
