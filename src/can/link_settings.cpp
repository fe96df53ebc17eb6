// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "can/link_settings.h"

#include <linux/capability.h>
#include <linux/if.h>
#include <linux/netlink.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>

#include "can/link_message.h"
#include "common/text.h"

namespace cia402::can {
namespace {

constexpr std::uint32_t kLongQueue = 100;     // frames
constexpr std::uint32_t kSlowRestart = 1000;  // ms
constexpr unsigned kLongFrame = 135;          // bits of 8 bytes with stuff bits, at most
constexpr double kNearSamplePoint = 0.0505;   // Linux' 75 % at 1 Mbit/s is near 70 and 80 %

std::string setUp(const LinkSettings& link, const std::string& options) {
  return "`ip link set " + link.name + " down; ip link set " + link.name + " up type can " +
         options + "` as root";
}

}  // namespace

std::vector<LinkFinding> findingsOf(const LinkSettings& link, unsigned bitrate,
                                    Duration sync_period, bool may_restart) {
  std::vector<LinkFinding> findings;
  const std::string wanted = "bitrate " + std::to_string(bitrate);
  if (link.bitrate && *link.bitrate != bitrate) {
    findings.push_back({true, link.name + " runs at " + std::to_string(*link.bitrate) +
                                  " bit/s, the configuration says bus/bitrate " +
                                  std::to_string(bitrate) + ": run " +
                                  setUp(link, wanted + " restart-ms 100") +
                                  ", or correct the configuration"});
  }
  if (link.listen_only) {
    findings.push_back({true, link.name + " only listens, no frame leaves: run " +
                                  setUp(link, wanted + " listen-only off")});
  }
  if (link.one_shot) {
    findings.push_back({false, link.name +
                                   " sends every frame once only, a disturbed one is lost: run " +
                                   setUp(link, wanted + " one-shot off")});
  }
  const bool nobody =
      link.restart_ms && *link.restart_ms == 0 && (!may_restart || !link.real_controller);
  if (nobody) {
    const std::string remedy =
        link.real_controller
            ? "run " + setUp(link, wanted + " restart-ms 100") + ", or give the node CAP_NET_ADMIN"
            : "`ip link set " + link.name + " down; ip link set " + link.name +
                  " up` as root brings it back";
    findings.push_back(
        {false, link.name + " stays off after bus-off: restart-ms is 0 and the driver " +
                    (link.real_controller ? "may not" : "cannot") + " restart it; " + remedy});
  }
  if (link.restart_ms && *link.restart_ms > kSlowRestart) {
    findings.push_back({false, link.name + " is restarted only " +
                                   std::to_string(*link.restart_ms) + " ms after bus-off: run " +
                                   setUp(link, wanted + " restart-ms 100")});
  }
  const bool virtual_bus = link.kind == "vcan";  // hands frames over at once, queues none
  if (!virtual_bus && link.tx_queue_length && *link.tx_queue_length > kLongQueue) {
    const double late = kLongFrame * 1e3 * *link.tx_queue_length / bitrate;
    char text[160];
    std::snprintf(text, sizeof text,
                  ": after a hang of the bus the kernel may send commands that are %.0f ms and "
                  "more old, in a cycle of %.1f ms",
                  late, 1e3 * toSeconds(sync_period));
    findings.push_back({false, link.name + " queues " + std::to_string(*link.tx_queue_length) +
                                   " frames" + text + ": run `ip link set " + link.name +
                                   " txqueuelen 10` as root"});
  }
  return findings;
}

std::optional<LinkFinding> samplePointFinding(const LinkSettings& link, unsigned bitrate,
                                              const SamplePoints& devices) {
  if (!link.sample_point || devices.choices.empty()) return {};
  std::string points;
  for (const double point : devices.choices) {
    if (std::fabs(point - *link.sample_point) < kNearSamplePoint) return {};
    points += (points.empty() ? "" : " or ") + percentText(point, 1);
  }
  char best[16];
  std::snprintf(best, sizeof best, "%.3f", devices.choices.front());
  return LinkFinding{
      false, link.name + " reads a bit at " + percentText(*link.sample_point, 1) +
                 " of its time, " + devices.who + " at " + points +
                 ": frames may be destroyed on a long or disturbed cable; run " +
                 setUp(link, "bitrate " + std::to_string(bitrate) + " sample-point " + best)};
}

bool mayConfigureLinks() {
  __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
  std::array<__user_cap_data_struct, _LINUX_CAPABILITY_U32S_3> sets{};
  if (::syscall(SYS_capget, &header, sets.data()) != 0) return false;
  return (sets[CAP_TO_INDEX(CAP_NET_ADMIN)].effective & CAP_TO_MASK(CAP_NET_ADMIN)) != 0;
}

LinkReader::LinkReader()
    : socket_(::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, NETLINK_ROUTE)) {}

LinkReader::~LinkReader() {
  if (socket_ >= 0) ::close(socket_);
}

namespace {

using Answer = std::array<std::uint8_t, 16384>;

// Sends a request and takes its answer, which the kernel has given before send() returns.
// @return its size, 0 if there is none.
std::size_t exchange(int socket, const std::vector<std::uint8_t>& request, Answer& answer) {
  while (::recv(socket, answer.data(), answer.size(), 0) > 0) {
    // an answer that nobody waited for
  }
  if (::send(socket, request.data(), request.size(), 0) < 0) return 0;
  const ssize_t size = ::recv(socket, answer.data(), answer.size(), 0);
  return size > 0 ? static_cast<std::size_t>(size) : 0;
}

}  // namespace

std::optional<LinkSettings> LinkReader::read(const std::string& name) const {
  if (name.empty() || name.size() >= IFNAMSIZ) return std::nullopt;
  Answer answer;
  const std::size_t size = exchange(socket_, linkRequest(name, 1), answer);
  return parseLink(answer.data(), size);
}

int LinkReader::restart(const LinkSettings& link) const {
  // Drivers without a bit timing of their own (serial adapters) have no restart either, and older
  // kernels crash when asked for it.
  if (!link.real_controller) return EOPNOTSUPP;
  Answer answer;
  const std::size_t size = exchange(socket_, restartRequest(link.index, 2), answer);
  return parseAcknowledgement(answer.data(), size).value_or(EIO);
}

}  // namespace cia402::can
