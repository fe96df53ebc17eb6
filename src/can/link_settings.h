// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "can/bus.h"
#include "cia402_driver/common/time.h"

namespace cia402::can {

/// What the kernel knows of a CAN interface. What is absent does not exist for this kind of
/// interface: a virtual one has no bit rate and no controller.
struct LinkSettings {
  std::string name;
  int index = 0;
  std::string kind;      ///< "can", "vcan", ...; empty: the kernel does not say
  bool up = false;       ///< set up by the administrator
  bool carrier = false;  ///< the driver takes frames; it does not while the controller is bus-off
  std::optional<std::uint32_t> tx_queue_length;  ///< frames that the kernel queues (txqueuelen)
  std::optional<std::uint32_t> bitrate;          ///< bit/s; 0: not configured
  std::optional<double> sample_point;            ///< share of a bit after which it is read
  std::optional<BusState> controller;            ///< `down` while stopped or asleep
  std::optional<std::uint16_t> transmit_errors, receive_errors;  ///< the controller's counters
  std::optional<std::uint32_t> restart_ms;  ///< the kernel restarts after so long; 0: never
  bool error_reporting = false;             ///< single bus errors are reported (berr-reporting)
  bool listen_only = false, loopback = false, one_shot = false;
  /// The driver knows its controller's bit timing: a real controller that can be restarted.
  bool real_controller = false;
  /// Events since the interface was created, counted by the kernel.
  struct Events {
    std::uint32_t bus_errors = 0, warnings = 0, passives = 0, bus_offs = 0, arbitration_lost = 0,
                  restarts = 0;
  };
  std::optional<Events> events;
  /// Frames and bytes of data since the interface was created, counted by the kernel: all that the
  /// controller received and sent, whatever filters sockets have.
  struct Traffic {
    std::uint64_t frames_received = 0, frames_sent = 0, bytes_received = 0, bytes_sent = 0;
    std::uint64_t frames() const { return frames_received + frames_sent; }
    std::uint64_t bytes() const { return bytes_received + bytes_sent; }
  };
  std::optional<Traffic> traffic;
};

/// Something about the settings that people should know or change.
struct LinkFinding {
  bool error = false;  ///< nothing will work like this; else it may fail one day
  std::string text;    ///< a sentence with what to do
};

/// What is wrong with these settings for a bus of `bitrate` bit/s whose cycle lasts `sync_period`.
/// @param may_restart whether the driver may restart a controller (mayConfigureLinks()).
std::vector<LinkFinding> findingsOf(const LinkSettings& link, unsigned bitrate,
                                    Duration sync_period, bool may_restart);
/// Where devices of the bus read a bit, which the others are to do nearly alike.
struct SamplePoints {
  std::string who;              ///< "shoulder, elbow (sv660c)"
  std::vector<double> choices;  ///< shares of a bit, what they best have first; one is enough
};
/// That the controller of `link` does it far from each of them; nothing where that is not known.
std::optional<LinkFinding> samplePointFinding(const LinkSettings& link, unsigned bitrate,
                                              const SamplePoints& devices);
/// Whether this process has CAP_NET_ADMIN.
bool mayConfigureLinks();

/// Asks the kernel about interfaces (rtnetlink). May wait a few milliseconds while another process
/// configures interfaces: not for the cycle.
class LinkReader {
 public:
  /// Opens a netlink socket; where that fails nothing can be read.
  LinkReader();
  ~LinkReader();
  LinkReader(const LinkReader&) = delete;
  LinkReader& operator=(const LinkReader&) = delete;

  /// @return nothing if there is no such interface or the kernel does not answer.
  std::optional<LinkSettings> read(const std::string& name) const;
  /// Asks the kernel to restart the bus-off controller of `link` (needs CAP_NET_ADMIN).
  /// @return 0, or an errno value; EOPNOTSUPP where the link has none that can be restarted.
  int restart(const LinkSettings& link) const;

 private:
  int socket_;
};

}  // namespace cia402::can
