// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "can/link_message.h"

#include <linux/can/netlink.h>
#include <linux/if.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>

#include <algorithm>
#include <cstring>

namespace cia402::can {
namespace {

// A view of bytes that are not trusted.
struct View {
  const std::uint8_t* data = nullptr;
  std::size_t size = 0;

  template <typename T>
  std::optional<T> as() const {
    if (size < sizeof(T)) return std::nullopt;
    T value;
    std::memcpy(&value, data, sizeof value);
    return value;
  }
  // Up to the first zero.
  std::string text() const {
    const auto* const end = std::find(data, data + size, std::uint8_t{0});
    return {reinterpret_cast<const char*>(data), static_cast<std::size_t>(end - data)};
  }
};

std::size_t aligned(std::size_t size) { return (size + 3U) & ~std::size_t{3}; }

// Calls `use(type, content)` for every attribute.
template <typename Use>
void forEachAttribute(View view, Use&& use) {
  while (const auto header = view.as<rtattr>()) {
    if (header->rta_len < sizeof(rtattr) || header->rta_len > view.size) return;
    use(static_cast<unsigned>(header->rta_type & NLA_TYPE_MASK),
        View{view.data + sizeof(rtattr), header->rta_len - sizeof(rtattr)});
    const std::size_t step = std::min(aligned(header->rta_len), view.size);
    view = {view.data + step, view.size - step};
  }
}

std::optional<BusState> stateOf(std::uint32_t kernel_state) {
  switch (kernel_state) {
    case CAN_STATE_ERROR_ACTIVE:
      return BusState::error_active;
    case CAN_STATE_ERROR_WARNING:
      return BusState::error_warning;
    case CAN_STATE_ERROR_PASSIVE:
      return BusState::error_passive;
    case CAN_STATE_BUS_OFF:
      return BusState::bus_off;
    case CAN_STATE_STOPPED:
    case CAN_STATE_SLEEPING:
      return BusState::down;
    default:
      return std::nullopt;
  }
}

void takeCan(unsigned type, View content, LinkSettings& link) {
  switch (type) {
    case IFLA_CAN_BITTIMING:
      if (const auto timing = content.as<can_bittiming>()) {
        link.bitrate = timing->bitrate;
        // In thousandths; a driver that does not know it says 0.
        if (timing->sample_point != 0) link.sample_point = 1e-3 * timing->sample_point;
      }
      break;
    case IFLA_CAN_BITTIMING_CONST:
      link.real_controller = true;
      break;
    case IFLA_CAN_STATE:
      if (const auto state = content.as<std::uint32_t>()) link.controller = stateOf(*state);
      break;
    case IFLA_CAN_RESTART_MS:
      link.restart_ms = content.as<std::uint32_t>();
      break;
    case IFLA_CAN_CTRLMODE:
      if (const auto mode = content.as<can_ctrlmode>()) {
        link.error_reporting = (mode->flags & CAN_CTRLMODE_BERR_REPORTING) != 0;
        link.listen_only = (mode->flags & CAN_CTRLMODE_LISTENONLY) != 0;
        link.loopback = (mode->flags & CAN_CTRLMODE_LOOPBACK) != 0;
        link.one_shot = (mode->flags & CAN_CTRLMODE_ONE_SHOT) != 0;
      }
      break;
    case IFLA_CAN_BERR_COUNTER:
      if (const auto counter = content.as<can_berr_counter>()) {
        link.transmit_errors = counter->txerr;
        link.receive_errors = counter->rxerr;
      }
      break;
    default:
      break;
  }
}

void takeLinkInfo(View info, LinkSettings& link) {
  forEachAttribute(info, [&](unsigned type, View content) {
    if (type == IFLA_INFO_KIND) link.kind = content.text();
  });
  if (link.kind != "can") return;  // other kinds mean other things by the same numbers
  forEachAttribute(info, [&](unsigned type, View content) {
    if (type == IFLA_INFO_DATA) {
      forEachAttribute(content, [&](unsigned can, View value) { takeCan(can, value, link); });
    } else if (type == IFLA_INFO_XSTATS) {
      if (const auto stats = content.as<can_device_stats>()) {
        link.events =
            LinkSettings::Events{stats->bus_error, stats->error_warning,    stats->error_passive,
                                 stats->bus_off,   stats->arbitration_lost, stats->restarts};
      }
    }
  });
}

// The first four counters of rtnl_link_stats64; the rest differs with the kernel's age.
void takeStatistics(View content, LinkSettings& link) {
  struct Counters {
    std::uint64_t rx_packets, tx_packets, rx_bytes, tx_bytes;
  };
  const auto counters = content.as<Counters>();
  if (!counters) return;
  link.traffic = LinkSettings::Traffic{counters->rx_packets, counters->tx_packets,
                                       counters->rx_bytes, counters->tx_bytes};
}

// Puts a message together.
class Writer {
 public:
  Writer(std::uint16_t type, std::uint16_t flags, std::uint32_t sequence, int index) {
    nlmsghdr header{};
    header.nlmsg_type = type;
    header.nlmsg_flags = flags;
    header.nlmsg_seq = sequence;
    append(&header, sizeof header);
    ifinfomsg info{};
    info.ifi_index = index;
    append(&info, sizeof info);
  }
  std::size_t begin(std::uint16_t type) {
    rtattr attribute{};
    attribute.rta_type = type;
    const std::size_t place = bytes_.size();
    append(&attribute, sizeof attribute);
    return place;
  }
  void end(std::size_t place) {
    const auto length = static_cast<std::uint16_t>(bytes_.size() - place);
    std::memcpy(bytes_.data() + place, &length, sizeof length);  // rta_len is first
    bytes_.resize(aligned(bytes_.size()));
  }
  void attribute(std::uint16_t type, const void* data, std::size_t size) {
    const std::size_t place = begin(type);
    append(data, size);
    end(place);
  }
  std::vector<std::uint8_t> finish() {
    const auto length = static_cast<std::uint32_t>(bytes_.size());
    std::memcpy(bytes_.data(), &length, sizeof length);  // nlmsg_len is first
    return std::move(bytes_);
  }

 private:
  void append(const void* data, std::size_t size) {
    const auto* const from = static_cast<const std::uint8_t*>(data);
    bytes_.insert(bytes_.end(), from, from + size);
  }
  std::vector<std::uint8_t> bytes_;
};

}  // namespace

std::vector<std::uint8_t> linkRequest(const std::string& name, std::uint32_t sequence) {
  Writer writer(RTM_GETLINK, NLM_F_REQUEST, sequence, 0);
  writer.attribute(IFLA_IFNAME, name.c_str(), name.size() + 1);
  return writer.finish();
}

std::vector<std::uint8_t> restartRequest(int index, std::uint32_t sequence) {
  Writer writer(RTM_NEWLINK, NLM_F_REQUEST | NLM_F_ACK, sequence, index);
  const std::size_t info = writer.begin(IFLA_LINKINFO);
  writer.attribute(IFLA_INFO_KIND, "can", 3);
  const std::size_t data = writer.begin(IFLA_INFO_DATA);
  const std::uint32_t yes = 1;
  writer.attribute(IFLA_CAN_RESTART, &yes, sizeof yes);
  writer.end(data);
  writer.end(info);
  return writer.finish();
}

std::optional<LinkSettings> parseLink(const std::uint8_t* message, std::size_t size) {
  const View whole{message, size};
  const auto header = whole.as<nlmsghdr>();
  if (!header || header->nlmsg_type != RTM_NEWLINK || header->nlmsg_len > size) return {};
  if (header->nlmsg_len < sizeof(nlmsghdr) + sizeof(ifinfomsg)) return {};
  const View body{message + sizeof(nlmsghdr), header->nlmsg_len - sizeof(nlmsghdr)};
  const ifinfomsg info = *body.as<ifinfomsg>();
  LinkSettings link;
  link.index = info.ifi_index;
  link.up = (info.ifi_flags & IFF_UP) != 0;
  link.carrier = (info.ifi_flags & IFF_LOWER_UP) != 0;
  const View attributes{body.data + sizeof(ifinfomsg), body.size - sizeof(ifinfomsg)};
  forEachAttribute(attributes, [&](unsigned type, View content) {
    if (type == IFLA_IFNAME) link.name = content.text();
    if (type == IFLA_TXQLEN) link.tx_queue_length = content.as<std::uint32_t>();
    if (type == IFLA_LINKINFO) takeLinkInfo(content, link);
    if (type == IFLA_STATS64) takeStatistics(content, link);
  });
  return link;
}

std::optional<int> parseAcknowledgement(const std::uint8_t* message, std::size_t size) {
  const View whole{message, size};
  const auto header = whole.as<nlmsghdr>();
  if (!header || header->nlmsg_type != NLMSG_ERROR) return {};
  const auto error = View{message + sizeof(nlmsghdr), size - sizeof(nlmsghdr)}.as<std::int32_t>();
  if (!error) return {};
  return -*error;
}

}  // namespace cia402::can
