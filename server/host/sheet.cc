// SPDX-License-Identifier: MIT
#include "server/host/sheet.h"

#include <qrencode.h>

#include <memory>

#include <spdlog/fmt/fmt.h>

namespace coopdyn {
namespace {

std::string Escaped(const std::string& text) {
  std::string html;
  for (const char c : text) {
    switch (c) {
      case '&':
        html += "&amp;";
        break;
      case '<':
        html += "&lt;";
        break;
      case '>':
        html += "&gt;";
        break;
      case '"':
        html += "&quot;";
        break;
      default:
        html += c;
    }
  }
  return html;
}

constexpr const char* kHead = R"(<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>Class sheet</title>
<link rel="icon" href="../icon.svg" type="image/svg+xml"><link rel="stylesheet" href="../sheet.css"></head><body>
)";

}  // namespace

std::string QrSvg(const std::string& text) {
  const std::unique_ptr<QRcode, void (*)(QRcode*)> code(
      QRcode_encodeString8bit(text.c_str(), 0, QR_ECLEVEL_M), QRcode_free);
  if (code == nullptr) return {};
  constexpr int kMargin = 4;  // modules, as the standard wants
  const int size = code->width + 2 * kMargin;
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {0}\" shape-rendering=\"crispEdges\" "
      "role=\"img\" "
      "aria-label=\"QR code\"><rect width=\"{0}\" height=\"{0}\" fill=\"#fff\"/><path d=\"",
      size);
  for (int y = 0; y < code->width; ++y) {
    for (int x = 0; x < code->width; ++x) {
      if ((code->data[y * code->width + x] & 1) != 0)
        svg += fmt::format("M{} {}h1v1h-1z", x + kMargin, y + kMargin);
    }
  }
  return svg + "\"/></svg>";
}

std::string SheetPage(const Roll& roll, const std::string& url) {
  std::string html = kHead;
  for (const RollEntry& entry : roll.entries()) {
    const std::string link = url + "l/" + entry.link;
    html += fmt::format(
        "<article>{}<div><h2>{}</h2><p>Seat <b>{}</b>{}</p><p class=\"pin\">{}</p><p><small>{}</small></p>"
        "<p><small>Python: connect(seat=\"{}\", pin=\"{}\")</small></p></div></article>\n",
        QrSvg(link), Escaped(entry.name), Escaped(entry.seat),
        entry.group.empty() ? "" : " &middot; " + Escaped(entry.group), Escaped(entry.pin), Escaped(link),
        Escaped(entry.seat), Escaped(entry.pin));
  }
  return html + "</body></html>\n";
}

}  // namespace coopdyn
