// SPDX-License-Identifier: MIT
// Messages of the page that are eight times as long take about eight times as long to read.
#include <gtest/gtest.h>

#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/string_body.hpp>
#include <string>

#include "server/web/http_routes.h"
#include "server/web/http_session.h"
#include "server/web/page_message.h"
#include "tests/cpu.h"

namespace coopdyn {
namespace {

namespace http = boost::beast::http;

using Kind = GrowingText;

class LinearPageTest : public testing::TestWithParam<Kind> {};

TEST_P(LinearPageTest, Reading) {
  ExpectLinear([&](std::size_t n) { ReadPageMessage(GetParam().Of(n)); }, 200'000 / GetParam().part.size());
}

const std::string kCall = R"({"id":1,"module":"/robot1/motors","command":"set_velocity",)";

INSTANTIATE_TEST_SUITE_P(
    OfMessages, LinearPageTest,
    testing::Values(Kind{"data", kCall + R"("data":[0)", ",0.1", "]}"},
                    Kind{"params", kCall + R"("params":[0)", ",7", "]}"},
                    Kind{"text", kCall + R"("text":")", "x", R"("})"},
                    Kind{"escapes", kCall + R"("text":")", R"(\u00e4)", R"("})"},
                    Kind{"a name", R"({"module":")", "x", R"("})"},
                    Kind{"a line", R"({"id":1,"module":"/robot1/motors","line":")", "1 ", R"("})"},
                    Kind{"keys of one name", "{", R"("id":1,)", R"("id":1})"}, Kind{"arrays", "", "[", ""},
                    Kind{"objects", "", R"({"a":)", ""}, Kind{"an id", R"({"id":[0)", ",0", "]}"},
                    Kind{"spaces", "{", " ", "}"}, Kind{"a number", R"({"id":)", "1", "}"}));

class LinearHttpTest : public testing::TestWithParam<Kind> {};

/// Parses bytes one by one, as a session does.
TEST_P(LinearHttpTest, ReadingInPieces) {
  const auto read = [](std::size_t n) {
    const std::string bytes = GetParam().Of(n);
    http::request_parser<http::string_body> parser;
    parser.header_limit(HttpSession::kMaxHeaderBytes);
    parser.body_limit(HttpSession::kMaxBodyBytes);
    parser.eager(true);
    boost::beast::flat_buffer buffer;
    for (std::size_t at = 0; at < bytes.size() && !parser.is_done();) {
      const std::size_t count = std::min<std::size_t>(100, bytes.size() - at);
      std::memcpy(buffer.prepare(count).data(), bytes.data() + at, count);
      buffer.commit(count);
      at += count;
      boost::beast::error_code failed;
      buffer.consume(parser.put(buffer.data(), failed));
      if (failed && failed != http::error::need_more) return;
    }
  };
  ExpectLinear(read, 200'000 / GetParam().part.size());
}

const std::string kPost = "POST /api/call HTTP/1.1\r\nHost: localhost\r\n";

INSTANTIATE_TEST_SUITE_P(
    OfRequests, LinearHttpTest,
    testing::Values(Kind{"a target", "GET /", "a", " HTTP/1.1\r\n\r\n"},
                    Kind{"headers", "GET / HTTP/1.1\r\n", "A: b\r\n", "\r\n"},
                    Kind{"a header", "GET / HTTP/1.1\r\nA: ", "b", "\r\n\r\n"},
                    Kind{"a body", kPost + "Content-Length: 10000000\r\n\r\n", "x", ""},
                    Kind{"chunks", kPost + "Transfer-Encoding: chunked\r\n\r\n", "1\r\nx\r\n", "0\r\n\r\n"},
                    Kind{"a chunk's extension", kPost + "Transfer-Encoding: chunked\r\n\r\n1;", "x", ""}));

class LinearRouteTest : public testing::TestWithParam<Kind> {};

TEST_P(LinearRouteTest, Finding) {
  const auto find = [](std::size_t n) {
    const std::string target = GetParam().Of(n);
    HttpRequestHead head;
    head.method = "GET";
    head.target = target;
    head.hosts = {"localhost"};
    FindRoute(head, {});
  };
  ExpectLinear(find, 100'000 / GetParam().part.size());
}

INSTANTIATE_TEST_SUITE_P(OfTargets, LinearRouteTest,
                         testing::Values(Kind{"slashes", "", "/", ""}, Kind{"dots", "/", "../", ""},
                                         Kind{"escapes", "/runs/", "%41", ".run"},
                                         Kind{"a name", "/robots/", "a", ""},
                                         Kind{"a query of pictures", "/snapshot.png?", "w=640&", ""},
                                         Kind{"numbers", "/snapshot.png?eye=", "1,", ""},
                                         Kind{"a query of runs", "/runs/a.run/table?", "rate=1&", ""}));

}  // namespace
}  // namespace coopdyn
