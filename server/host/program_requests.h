// SPDX-License-Identifier: MIT
// What a page asks of the program of its seat, over HTTP. The io_context's thread.
#pragma once

#include <string>
#include <string_view>

#include "server/host/program.h"
#include "server/web/http_routes.h"

namespace coopdyn {

/// `what`: the end of the address. GET: "" the text and the state, "output/FROM". POST, with `body`: "" keeps
/// a text, "run" keeps and runs it, "stop". `teaches`: the teacher asks, who may read and stop.
HttpAnswer AnswerProgram(Program& program, bool post, std::string_view what, const std::string& body,
                         bool teaches);

}  // namespace coopdyn
