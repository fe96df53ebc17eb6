// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "can/link_probe.h"

#include <linux/if.h>
#include <linux/if_arp.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>

namespace cia402::can {
namespace {

ifreq requestFor(const std::string& name) {
  ifreq request{};
  std::memcpy(request.ifr_name, name.c_str(), std::min<std::size_t>(name.size(), IFNAMSIZ - 1));
  return request;
}

bool validName(const std::string& name) { return !name.empty() && name.size() < IFNAMSIZ; }

struct GetLink {
  nlmsghdr header;
  ifinfomsg info;
  rtattr attribute;
  char name[IFNAMSIZ];
};

}  // namespace

LinkProbe::LinkProbe()
    : ioctl_socket_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)),
      netlink_(::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, NETLINK_ROUTE)) {}

LinkProbe::~LinkProbe() {
  if (ioctl_socket_ >= 0) ::close(ioctl_socket_);
  if (netlink_ >= 0) ::close(netlink_);
}

Link LinkProbe::look(const std::string& name) const {
  Link link;
  if (!validName(name)) return link;
  ifreq request = requestFor(name);
  if (::ioctl(ioctl_socket_, SIOCGIFINDEX, &request) != 0) return link;
  link.index = request.ifr_ifindex;
  request = requestFor(name);
  if (::ioctl(ioctl_socket_, SIOCGIFFLAGS, &request) != 0) return link;
  link.exists = true;
  link.up = (request.ifr_flags & IFF_UP) != 0;
  link.running = (request.ifr_flags & IFF_RUNNING) != 0;
  return link;
}

bool LinkProbe::isCan(const std::string& name) const {
  if (!validName(name)) return false;
  ifreq request = requestFor(name);
  return ::ioctl(ioctl_socket_, SIOCGIFHWADDR, &request) == 0 &&
         request.ifr_hwaddr.sa_family == ARPHRD_CAN;
}

bool LinkProbe::exists(const std::string& name) const {
  if (!validName(name)) return false;
  GetLink request{};
  request.header.nlmsg_len = NLMSG_LENGTH(sizeof(ifinfomsg)) + RTA_LENGTH(IFNAMSIZ);
  request.header.nlmsg_type = RTM_GETLINK;
  request.header.nlmsg_flags = NLM_F_REQUEST;
  request.attribute.rta_type = IFLA_IFNAME;
  request.attribute.rta_len = RTA_LENGTH(IFNAMSIZ);
  std::memcpy(request.name, name.c_str(), name.size() + 1);
  if (::send(netlink_, &request, request.header.nlmsg_len, 0) < 0) return look(name).exists;
  // The kernel has answered before send() returned.
  alignas(nlmsghdr) char answer[sizeof(nlmsghdr)];
  const ssize_t size = ::recv(netlink_, answer, sizeof answer, MSG_TRUNC);
  if (size < static_cast<ssize_t>(sizeof answer)) return look(name).exists;
  nlmsghdr header{};
  std::memcpy(&header, answer, sizeof header);
  return header.nlmsg_type == RTM_NEWLINK;
}

}  // namespace cia402::can
