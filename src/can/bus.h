// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "can/frame.h"
#include "cia402_driver/common/time.h"

namespace cia402::can {

/// Where a protocol stack puts the frames it wants on the wire.
class Sink {
 public:
  virtual ~Sink() = default;
  /// Queues one frame. Never blocks. The frames of one sink leave in the order they were given
  /// within each identifier. @return false if the frame could not be taken (queue full or interface
  /// down); the sink counts such losses, they are never silent.
  virtual bool send(const Frame& frame) = 0;
};

/// The controller's fault confinement state (ISO 11898-1) or why there is no bus at all.
enum class BusState { missing, down, error_active, error_warning, error_passive, bus_off };

/// A bus state in words, e.g. "error passive".
const char* toString(BusState state);

/// Counters since start; all only ever grow.
struct BusCounters {
  std::uint64_t frames_sent = 0;
  std::uint64_t frames_received = 0;
  std::uint64_t frames_deferred = 0;  ///< waited in our own queue, the kernel's was full (ENOBUFS)
  std::uint64_t frames_dropped = 0;   ///< refused: own queue full, or interface down
  std::uint64_t error_frames = 0;
  std::uint64_t bus_off_events = 0;
  std::uint64_t interface_losses = 0;   ///< the interface went down or was removed
  std::uint64_t receive_overflows = 0;  ///< frames lost by the controller or the kernel
  /// Waited too long to be true, or a newer one of the same identifier came: thrown away.
  std::uint64_t frames_stale = 0;
  /// Error frames of each class; the place is the bit of the class in error_frame.h, e.g. 1 for
  /// lost arbitration. A frame may have several classes.
  std::array<std::uint64_t, 10> error_classes{};
  std::uint64_t restart_attempts = 0;  ///< that the driver asked for after bus-off
  std::uint64_t restarts = 0;          ///< returns from bus-off, whoever restarted
};

/// What an interface has received.
struct ReceivedFrame {
  Frame frame;
  Time stamp;  ///< when the frame was on the wire (kernel time stamp mapped to BusClock)
};

/// A CAN interface: the edge where I/O happens. Never blocks; used by one thread only.
class Interface : public Sink {
 public:
  /// The next received frame, or nothing. Error frames are delivered, too.
  virtual std::optional<ReceivedFrame> receive(Time now) = 0;
  /// To be called regularly (every cycle): sends deferred frames, re-opens a lost interface.
  virtual void maintain(Time now) = 0;
  /// When receive() or maintain() has something to do at the latest, beside what fd() announces.
  virtual Time nextDeadline() const { return kNever; }
  /// A file descriptor that poll()s readable when receive() has something; -1 if there is none.
  virtual int fd() const = 0;
  virtual BusState state() const = 0;
  virtual const BusCounters& counters() const = 0;
  /// State in words with the reason and what to do, e.g. "can0 does not exist: plug the adapter in
  /// or run `ip link add ...`".
  virtual std::string describe() const = 0;
  /// What is done about bus-off, what came of it and what to do; empty if there is nothing to tell.
  virtual std::string recovery() const { return {}; }
  /// Frames that wait in the driver.
  virtual std::size_t pending() const { return 0; }
  /// The controller's error counters as the last error frame told them; absent: not told yet.
  struct ErrorCounters {
    std::uint8_t transmit = 0, receive = 0;
  };
  virtual std::optional<ErrorCounters> errorCounters() const { return std::nullopt; }
};

}  // namespace cia402::can
