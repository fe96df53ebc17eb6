// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "can/bus.h"
#include "can/frame.h"
#include "cia402_driver/common/time.h"
#include "sim/bus/faults.h"

namespace cia402::sim {

/// The software behind a port: a simulated drive, a master under test. Called from Bus::advance()
/// with the true time on the bus (onStateChange() also from the port's own switches); it may send
/// on its port, but not advance the bus.
class Listener {
 public:
  virtual ~Listener() = default;
  /// A frame of another port; `end_of_frame` is the end of the last bit of EOF.
  virtual void onFrame(const can::Frame& frame, Time end_of_frame) = 0;
  /// A frame of this port was acknowledged.
  virtual void onSent(const can::Frame&, Time /*end_of_frame*/) {}
  /// The fault confinement state of this port's controller has changed.
  virtual void onStateChange(can::BusState, Time) {}
};

/// Counters of one port since start.
struct PortCounters {
  std::uint64_t sent = 0;             ///< acknowledged frames
  std::uint64_t received = 0;         ///< frames given to the listener
  std::uint64_t dropped = 0;          ///< refused by send(), or discarded at bus-off or power-off
  std::uint64_t lost = 0;             ///< on the wire, but lost here by an injected fault
  std::uint64_t failed_attempts = 0;  ///< attempts ended by an error frame or without acknowledge
  std::uint64_t bus_off_events = 0;
};

class Bus;

/// A CAN controller on a simulated bus: a transmit queue in the order of arbitration (first in,
/// first out within an identifier; or in the order of send()), error counters and fault confinement
/// after ISO 11898-1. While the cable is pulled, or nobody acknowledges, frames wait and are sent
/// once they can be, stale as they are: that is what real controllers do.
class Port final : public can::Sink {
 public:
  /// Bus::attach() makes ports.
  Port(Bus& bus, Listener& listener, std::string name, std::size_t capacity);

  /// Queues a frame now, i.e. at Bus::now(). @return false, counted, if the queue is full, the
  /// controller is bus-off or without power, or the frame has no form on the wire.
  bool send(const can::Frame& frame) override;
  /// The same at `now`; a time before Bus::now() counts as Bus::now().
  bool send(const can::Frame& frame, Time now);

  /// Whether frames leave in the order in which they were given, as from the kernel's queue of a
  /// SocketCAN interface, instead of by arbitration. To be called while nothing waits. Default: no.
  void setFirstInFirstOut(bool on) { fifo_ = on; }
  /// Pulls (false) or plugs in the cable. Default: plugged in.
  void setAttached(bool attached);
  /// Takes the power away (queue and error counters are lost) or gives it back. Default: on.
  void setPowered(bool powered);
  bool attached() const { return attached_; }
  bool powered() const { return powered_; }

  /// Sends the controller to bus-off at once, as TEC > 255 does. The queue is discarded.
  void forceBusOff();
  /// Asks a bus-off controller to recover: it is error active again after 128 times 11 recessive
  /// bits, counted from now. Without effect in any other state.
  void requestRecovery();

  /// Error active to bus-off; `down` without power.
  can::BusState state() const { return state_; }
  unsigned transmitErrors() const { return tec_; }  ///< TEC; above 255: bus-off
  unsigned receiveErrors() const { return rec_; }   ///< REC
  const PortCounters& counters() const { return counters_; }
  const std::string& name() const { return name_; }
  /// Frames waiting, the one on the wire not included.
  std::size_t pending() const { return queue_.size(); }

 private:
  friend class Bus;

  struct Entry {
    std::uint32_t key = 0;   // the arbitration field as a number; the lower wins
    std::uint16_t bits = 0;  // exact length
    bool repeated = false;   // by an injected duplicate
    Time ready{};            // not before
    can::Frame frame;
  };

  void append(const Entry& entry, bool ahead_of_all);
  bool canTransmit() const { return on_bus_ && !queue_.empty(); }
  void insert(const Entry& entry, bool ahead_of_equals);
  const Entry* bestReadyAt(Time time) const;
  Time earliestReady() const;
  void discardQueue();
  void stopRecovery();
  void recovered(Time now);
  void refreshOnBus(Time now);
  void transmitFailed(bool missing_acknowledge, Time now);
  void transmitSucceeded(Time now);
  void receiveFailed(Time now);
  void receiveSucceeded(Time now);
  void updateState(Time now);

  Bus& bus_;
  Listener& listener_;
  std::string name_;
  std::size_t capacity_;
  std::vector<Entry> queue_;  // the next to leave is at the back
  bool fifo_ = false;
  unsigned tec_ = 0;
  unsigned rec_ = 0;
  bool attached_ = true;
  bool powered_ = true;
  bool on_bus_ = true;  // powered, attached, not bus-off
  bool recovering_ = false;
  unsigned recovery_left_ = 0;  // sequences of 11 recessive bits still to be seen
  Time recovery_since_{};       // start of the recessive bits not yet counted
  Time listening_since_{};      // a frame that began before this is not received
  Time suspended_until_{};      // suspend transmission of an error passive transmitter
  can::BusState state_ = can::BusState::error_active;
  PortCounters counters_;
};

/// What was on the wire since start.
struct BusTraffic {
  std::uint64_t frames = 0;        ///< acknowledged frames, injected duplicates included
  std::uint64_t error_frames = 0;  ///< error frames, missing acknowledges included
  std::uint64_t busy_bits = 0;     ///< bits of all of these with their intermissions
};

/// A classic CAN bus in virtual time: every frame has its true length, arbitration is by identifier
/// among the frames pending when the bus falls idle, and every other port on the bus receives a
/// frame at the end of its last bit. Nothing happens but in advance(). The steady state does not
/// allocate. Known simplifications: two ports that send the same identifier at once are served in
/// the order of attach() instead of colliding; the whole bus sees an injected disturbance, so that
/// no overload or secondary error frames arise.
class Bus {
 public:
  /// @param bitrate bits per second, e.g. 1e6; not positive throws std::invalid_argument.
  /// @param seed of the fault generator.
  explicit Bus(double bitrate, std::uint64_t seed = 1);

  /// Adds a controller. The listener must live as long as the bus, the port lives in the bus.
  /// Not to be called from a listener.
  Port& attach(Listener& listener, std::string name, std::size_t queue_capacity = 256);

  /// The time of the last event or advance(); a listener sees the time of its event.
  Time now() const { return now_; }
  /// Sets the time for sends without one; an earlier time than now() is ignored. The first time
  /// that the bus is given is the start of its load figure.
  void setTime(Time now);
  /// When the next frame ends (or a controller has recovered) if nothing else is sent; kNever if
  /// nothing is pending. After a failed attempt the true next event is later than told here.
  Time nextEvent() const;
  /// Everything that ends at or before `now`, in order. A frame that could start just at `now` is
  /// still open to arbitration afterwards.
  void advance(Time now);

  /// A node holds the bus dominant until then: nobody can begin to send, what is given to the
  /// controllers waits. (A real one would count errors, too.)
  void jam(Time until);

  /// Sees every frame on the wire, at its end, before the ports do; error frames as can::Frame with
  /// `error` set (class bits of linux/can/error.h).
  void setMonitor(std::function<void(const can::Frame&, Time)> monitor);
  /// A bus analyser acknowledges what is sent even if no other port is there to do so. Default:
  /// off.
  void setAnalyser(bool present) { analyser_ = present; }

  BusFaults& faults() { return faults_; }
  const BusTraffic& traffic() const { return traffic_; }
  /// Share of time in which the bus was busy since start, 0..1.
  double load() const;
  /// The same over the last second (full tenths of a second only), or since start if that is less.
  double recentLoad() const;
  double bitrate() const { return bitrate_; }
  /// Duration of a number of bits at this bit rate, rounded to nanoseconds.
  Duration bits(unsigned count) const;

 private:
  friend class Port;

  enum class Outcome { success, corrupted, unacknowledged, aborted };
  struct Candidate {
    Port* port = nullptr;
    Time start = kNever;
    const Port::Entry* entry = nullptr;
  };
  struct Transmission {
    Port* sender = nullptr;
    Port::Entry entry;
    Time start{};
    Time end{};         // of EOF, or of the error delimiter
    unsigned bits = 0;  // with the intermission
    Outcome outcome = Outcome::success;
  };

  Candidate arbitrate() const;
  Candidate winnerAmongReady(Time start) const;
  void start(const Candidate& winner);
  void finish();
  void deliver();
  void fail();
  void abort(const Port& sender);
  bool acknowledged(const Port& sender) const;
  Port* nextRecovery(Time& when) const;
  void countRecessiveUntil(Time start);
  void countRecessiveSequence();
  void account();

  double bitrate_;
  std::array<std::int64_t, 256> bit_times_{};  // ns of so many bits
  std::vector<std::unique_ptr<Port>> ports_;
  BusFaults faults_;
  std::function<void(const can::Frame&, Time)> monitor_;
  bool analyser_ = false;
  bool started_ = false;
  bool transmitting_ = false;
  unsigned recovering_ = 0;  // ports that recover from bus-off
  Time start_time_{};
  Time now_{};
  Time idle_at_{};  // the end of the last intermission
  Transmission wire_;
  BusTraffic traffic_;

  static constexpr std::size_t kSlots = 11;  // ten full tenths of a second and the running one
  std::array<Duration, kSlots> slot_busy_{};
  std::array<std::int64_t, kSlots> slot_number_{};
  Duration busy_{};
};

}  // namespace cia402::sim
