// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "can/socketcan.h"

#include <cerrno>
#include <system_error>
#include <utility>

#include "can/error_frame.h"
#include "can/link_probe.h"
#include "can/link_settings.h"
#include "can/raw_socket.h"
#include "can/wall_clock.h"

namespace cia402::can {

namespace {

// A controller's driver may hand out frames from before bus-off after telling it.
constexpr Duration kOldFrames = std::chrono::milliseconds(50);

}  // namespace

SocketCan::SocketCan(std::string name, Options options)
    : name_(std::move(name)),
      options_(std::move(options)),
      probe_(std::make_unique<LinkProbe>()),
      socket_(std::make_unique<RawSocket>()),
      pending_(options_.queue_capacity),
      reader_(std::make_unique<LinkReader>()),
      recovery_(options_.recovery) {
  checkLink();
}

SocketCan::~SocketCan() = default;

int SocketCan::fd() const { return socket_->fd(); }

bool SocketCan::canSend() const {
  return state_ == BusState::error_active || state_ == BusState::error_warning ||
         state_ == BusState::error_passive;
}

bool SocketCan::refuse() {
  ++counters_.frames_dropped;
  return false;
}

bool SocketCan::send(const Frame& frame) {
  const bool sendable =
      !frame.error && frame.size <= 8 && frame.id <= (frame.extended ? 0x1FFFFFFFU : 0x7FFU);
  if (!sendable) return refuse();
  flushPending();
  if (!canSend()) return refuse();
  if (pending_.empty()) {
    const Attempt result = attempt(frame);
    if (result == Attempt::sent) return true;
    if (result == Attempt::failed) return refuse();
  }
  const bool cyclic = !frame.extended && !frame.remote && options_.cyclic[frame.id];
  PendingQueue::Patience patience;
  patience.lifetime = cyclic ? options_.cyclic_lifetime : options_.other_lifetime;
  patience.newest_only = cyclic;
  const bool taken = pending_.push(frame, monotonicNow(), patience);
  countStale();
  if (!taken) return refuse();
  ++counters_.frames_deferred;
  return true;
}

SocketCan::Attempt SocketCan::attempt(const Frame& frame) {
  const int error = socket_->send(frame);
  if (error == 0) {
    ++counters_.frames_sent;
    return Attempt::sent;
  }
  if (error == ENOBUFS || error == EAGAIN || error == EINTR) return Attempt::busy;
  handleError(error);
  return Attempt::failed;
}

void SocketCan::flushPending() {
  if (pending_.empty() || !canSend()) return;
  pending_.flush(monotonicNow(), [this](const Frame& frame) {
    const Attempt result = attempt(frame);
    // Either this frame is lost alone, or handleError() has thrown it away with the whole queue.
    if (result == Attempt::failed && !pending_.empty()) ++counters_.frames_dropped;
    return result != Attempt::busy;
  });
  countStale();
}

std::optional<ReceivedFrame> SocketCan::receive(Time) {
  while (socket_->isOpen()) {
    if (auto received = socket_->pop()) {
      if (received->frame.error) {
        handleErrorFrame(received->frame, received->stamp);
      } else {
        ++counters_.frames_received;
        // A frame proves the controller back on the bus.
        if (state_ == BusState::bus_off && received->stamp > bus_off_at_ + kOldFrames) {
          comeBack(BusState::error_active);
        }
      }
      countOverflows();
      return received;
    }
    if (batch_done_ && socket_->drained()) {
      batch_done_ = false;
      return std::nullopt;
    }
    const int error = socket_->read();
    batch_done_ = error == 0;
    if (error == EAGAIN) return std::nullopt;
    if (error != 0 && error != EINTR) handleError(error);
  }
  return std::nullopt;
}

void SocketCan::countOverflows() {
  const std::uint32_t overflows = socket_->overflows();
  counters_.receive_overflows += overflows - overflows_seen_;
  overflows_seen_ = overflows;
}

void SocketCan::handleErrorFrame(const Frame& frame, Time stamp) {
  countErrorFrame(frame, counters_);
  last_error_frame_ = frame;
  if ((frame.id & error_class::kCounters) != 0) {
    error_counters_ = ErrorCounters{frame.data[6], frame.data[7]};
  }
  const BusState next = stateAfter(frame, state_);
  if (next == BusState::bus_off) bus_off_at_ = stamp;
  if (next == state_ || state_ == BusState::down) return;
  if (next == BusState::bus_off) {
    ++counters_.bus_off_events;
    carrier_was_lost_ = false;
    becomeUnusable(next);
  } else if (state_ == BusState::bus_off) {
    comeBack(next);
  } else {
    state_ = next;
  }
}

void SocketCan::comeBack(BusState state) {
  ++counters_.restarts;
  recovery_note_.clear();
  state_ = state;
}

void SocketCan::handleError(int error) {
  switch (error) {
    case ENETDOWN:
      // Reported once, maybe late: the interface may be up again. What waited is stale all the
      // same.
      becomeUnusable(BusState::down);
      checkLink();
      break;
    case ENODEV:
    case ENXIO:
      becomeUnusable(BusState::missing);
      closeSocket();
      break;
    default:
      break;  // concerns one frame only
  }
}

void SocketCan::becomeUnusable(BusState state) {
  const bool was_there = state_ != BusState::missing && state_ != BusState::down;
  if (was_there && state != BusState::bus_off) ++counters_.interface_losses;
  state_ = state;
  if (state != BusState::bus_off) recovery_note_.clear();
  counters_.frames_dropped += pending_.discard();
}

void SocketCan::maintain(Time now) {
  if (now >= next_check_) {
    next_check_ = now + options_.check_period;
    checkLink();
  }
  recovery_.update(state_, now);
  if (recovery_.attempt(now)) tryToReturn();
  flushPending();
}

/// The time for a restart has come: asks the kernel how things are, and for what is needed.
void SocketCan::tryToReturn() {
  const auto link = reader_->read(name_);
  if (!link || !link->up) return;  // checkLink() will find out
  if (link->controller == BusState::bus_off) {
    restart(*link);
  } else if (link->controller && *link->controller != BusState::down) {
    comeBack(*link->controller);
  } else if (!link->controller && link->carrier) {
    comeBack(BusState::error_active);
  }
}

void SocketCan::restart(const LinkSettings& link) {
  if (link.restart_ms.value_or(0) > 0) {
    recovery_note_ = name_ + " is bus-off: the kernel restarts it " +
                     std::to_string(*link.restart_ms) + " ms after each bus-off (restart-ms)";
    return;
  }
  ++counters_.restart_attempts;
  const int error = reader_->restart(link);
  const std::string kernel = "have the kernel do it: `ip link set " + name_ +
                             " down; ip link set " + name_ + " up type can bitrate " +
                             std::to_string(options_.bitrate) + " restart-ms 100` as root";
  switch (error) {
    case 0:
      recovery_note_ = name_ +
                       " is bus-off: the driver has asked the kernel to restart it, attempt " +
                       std::to_string(recovery_.attempts());
      break;
    case EPERM:
    case EACCES:
      recovery_note_ =
          name_ + " is bus-off, and the driver may not restart it (no CAP_NET_ADMIN): " +
          "run `ip link set " + name_ + " type can restart` as root, and from now on " + kernel;
      break;
    case EOPNOTSUPP:
      recovery_note_ = name_ + " is bus-off, and its kernel driver cannot restart it: run " +
                       "`ip link set " + name_ + " down; ip link set " + name_ + " up` as root";
      break;
    default:
      recovery_note_ = name_ + " is bus-off, and the kernel refused to restart it (" +
                       std::generic_category().message(error) + "): " + kernel;
      break;
  }
}

void SocketCan::checkLink() {
  const bool was_there = socket_->isOpen();
  if (!was_there && !probe_->exists(name_)) {
    open_error_ = 0;
    return becomeUnusable(BusState::missing);
  }
  const Link link = probe_->look(name_);
  if (was_there && link.index != socket_->interfaceIndex()) {
    becomeUnusable(BusState::missing);
    closeSocket();
  }
  if (!link.exists) return;
  if (!socket_->isOpen()) {
    open_error_ = probe_->isCan(name_) ? openSocket(link.index) : ENODEV;
    if (open_error_ != 0) return;
    batch_done_ = false;
    overflows_seen_ = 0;
    last_error_frame_.reset();
  }
  updateState(link.up, link.running);
}

void SocketCan::updateState(bool up, bool carrier) {
  if (!up) {
    if (state_ != BusState::down) becomeUnusable(BusState::down);
    return;
  }
  if (state_ == BusState::missing || state_ == BusState::down) {
    carrier_was_lost_ = !carrier;
    state_ = carrier ? BusState::error_active : BusState::bus_off;
  } else if (state_ == BusState::bus_off) {
    // The carrier follows the controller with a delay: believe it only after it was seen to go.
    if (carrier && carrier_was_lost_) comeBack(BusState::error_active);
    carrier_was_lost_ = carrier_was_lost_ || !carrier;
  }
}

int SocketCan::openSocket(int interface_index) {
  const std::lock_guard<std::mutex> lock(opening_);
  return socket_->open(interface_index, options_.filters, options_.receive_buffer,
                       options_.error_frames);
}

void SocketCan::closeSocket() {
  const std::lock_guard<std::mutex> lock(opening_);
  socket_->close();
}

void SocketCan::setFilters(std::vector<ReceiveFilter> filters) {
  const std::lock_guard<std::mutex> lock(opening_);
  options_.filters = std::move(filters);
  if (socket_->isOpen()) socket_->setFilters(options_.filters);
}

std::string SocketCan::lastErrorFrame() const {
  return last_error_frame_ ? describeErrorFrame(*last_error_frame_) : std::string();
}

std::string SocketCan::describe() const {
  const std::string last = last_error_frame_ ? "; last error: " + lastErrorFrame() : "";
  switch (state_) {
    case BusState::missing:
      return describeMissing();
    case BusState::down:
      return name_ + " is down: run `ip link set " + name_ + " up type can bitrate " +
             std::to_string(options_.bitrate) + " restart-ms 100` (a virtual one: `ip link set " +
             name_ + " up`) as root" + last;
    case BusState::bus_off:
      return name_ + " is bus-off, nothing is sent: check wiring, termination and bit rate" +
             (recovery_note_.empty() ? "; it is restarted soon" : "; " + recovery_note_) + last;
    case BusState::error_warning:
    case BusState::error_passive:
      return name_ + " is " + toString(state_) +
             ": check wiring, termination and bit rate, and that a drive is powered to "
             "acknowledge" +
             last;
    case BusState::error_active:
      break;
  }
  return name_ + " is up" + last;
}

std::string SocketCan::describeMissing() const {
  switch (open_error_) {
    case 0:
      return name_ + " does not exist: plug the CAN adapter in and load its driver, or create a " +
             "virtual interface by `ip link add dev " + name_ + " type vcan` as root";
    case EAFNOSUPPORT:
    case EPROTONOSUPPORT:
      return name_ +
             " cannot be used: this kernel has no CAN; run `modprobe can-raw` as root, or a " +
             "kernel with SocketCAN";
    case ENODEV:
      return name_ + " is not a CAN interface: check the name in bus/interface, see `ip link`";
    default:
      return name_ + " cannot be opened: " + std::generic_category().message(open_error_);
  }
}

}  // namespace cia402::can
