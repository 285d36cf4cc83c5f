// SPDX-License-Identifier: MIT
#include "server/web/web_server.h"

#include <memory>
#include <utility>

#include <boost/asio/ip/tcp.hpp>

#include "server/web/http_session.h"

namespace coopdyn {

WebServer::WebServer(WebOptions options, const NameTable& names, const FrameBoard& frames, ImageBoard* images,
                     NetServices& services)
    : services_(services),
      thread_("web", services.logger()),
      context_(thread_.context(), std::move(options), names, frames, images, services),
      listener_(thread_.context(), services,
                [this](UniqueFd fd, PeerInfo peer) { Accept(std::move(fd), std::move(peer)); }) {}

void WebServer::Stop() {
  if (std::exchange(stopped_, true)) return;
  thread_.Call([this] {
    context_.pictures.Stop();
    context_.runs.Stop();
    context_.files.Stop();
    context_.connections.CloseAll();
  });
  thread_.Stop();
}

void WebServer::Adopt(UniqueFd fd, PeerInfo peer, std::string already_read) {
  thread_.Post([this, held = std::make_shared<UniqueFd>(std::move(fd)), peer = std::move(peer),
                read = std::move(already_read)] {
    SetClientSocketOptions(held->get());
    Accept(std::move(*held), peer, read);
  });
}

void WebServer::Accept(UniqueFd fd, PeerInfo peer, std::string already_read) {
  using Verdict = WebConnections::Verdict;
  namespace ip = boost::asio::ip;
  const Verdict verdict = context_.connections.Admit(peer);
  if (verdict == Verdict::kDrop) return;
  ip::tcp::socket socket(thread_.context());
  boost::system::error_code failed;
  socket.assign(PeerAddress(fd.get()).ip.find(':') == std::string::npos ? ip::tcp::v4() : ip::tcp::v6(),
                fd.get(), failed);
  if (failed) return;
  fd.Release();
  const auto session = std::make_shared<HttpSession>(std::move(socket), context_, peer);
  context_.connections.Add(session, peer);
  if (verdict == Verdict::kServe) return session->Start(already_read);
  services_.LogPeer(spdlog::level::warn, peer.text, "too many connections to the page: refused");
  session->Refuse();
}

}  // namespace coopdyn
