// SPDX-License-Identifier: MIT
#include "server/web/web_server.h"

#include <utility>

#include <boost/asio/ip/tcp.hpp>

#include "server/net/io_thread.h"
#include "server/net/listener.h"
#include "server/web/http_session.h"
#include "server/web/web_context.h"

namespace coopdyn {

class WebServer::Impl {
 public:
  Impl(WebOptions options, const NameTable& names, const FrameBoard& frames, ImageBoard* images,
       NetServices& services)
      : services_(services),
        thread_("web", services.logger()),
        context_(thread_.context(), std::move(options), names, frames, images, services),
        listener_(thread_.context(), services,
                  [this](UniqueFd fd, PeerInfo peer) { Accept(std::move(fd), std::move(peer)); }) {}

  Listener& listener() { return listener_; }

  void Stop() {
    if (std::exchange(stopped_, true)) return;
    thread_.Call([this] {
      context_.pictures.Stop();
      context_.runs.Stop();
      context_.connections.CloseAll();
    });
    thread_.Stop();
  }

 private:
  void Accept(UniqueFd fd, PeerInfo peer) {
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
    if (verdict == Verdict::kServe) return session->Start();
    services_.LogPeer(spdlog::level::warn, peer.text, "too many connections to the page: refused");
    session->Refuse();
  }

  NetServices& services_;
  IoThread thread_;  // first: connections that are left end with its io_context
  WebContext context_;
  Listener listener_;
  bool stopped_ = false;
};

WebServer::WebServer(WebOptions options, const NameTable& names, const FrameBoard& frames, ImageBoard* images,
                     NetServices& services)
    : impl_(std::make_unique<Impl>(std::move(options), names, frames, images, services)) {}

WebServer::~WebServer() {
  Stop();
}

std::string WebServer::Listen(const std::vector<std::string>& addresses, int port) {
  return impl_->listener().Listen(addresses, port);
}

int WebServer::port() const {
  return impl_->listener().port();
}

void WebServer::Stop() {
  impl_->Stop();
}

}  // namespace coopdyn
