#include "periplus_robot.hpp"

#include <math.h>
#include <stdio.h>
#include <string.h>

namespace periplus {
namespace {
constexpr double kStep = 0.02;          // seconds between two calls of step()
constexpr double kWatchdog = 0.3;       // silence of the host after which the robot stops, seconds
constexpr int kReportSteps = 5;         // steps between two reports
constexpr int kAgainSteps = 5;          // steps before an event that was not confirmed is said again
constexpr int kStallSteps = 10;         // a stall is more steps driven without a tick than this,
constexpr double kStallTicks = 2;       // and a way for which more ticks than this were due

double clamp(double v, double low, double high) { return v < low ? low : v > high ? high : v; }

// A whole number as text: the printf of small C libraries (newlib-nano, AVR's) knows no 64 bits.
class Decimal {
 public:
  explicit Decimal(int64_t value) {
    uint64_t rest = value < 0 ? 0 - static_cast<uint64_t>(value) : static_cast<uint64_t>(value);
    do {
      digits_[--first_] = static_cast<char>('0' + rest % 10);
      rest /= 10;
    } while (rest);
    if (value < 0) digits_[--first_] = '-';
  }
  const char* text() const { return digits_ + first_; }

 private:
  char digits_[21] = {};  // 19 of them, a sign, and the end
  size_t first_ = sizeof digits_ - 1;
};

// The fields of a body, one after the other, each after a single space. scanf would take more than the page
// allows: signs, more spaces or none, numbers that do not fit.
class Fields {
 public:
  explicit Fields(const char* at) : at_(at) {}

  // A whole number without a sign.
  uint32_t number(uint32_t most = 0xFFFFFFFF, unsigned base = 10) {
    good_ = good_ && *at_++ == ' ';
    return good_ ? digits(most, base) : 0;
  }

  // One that may be negative.
  int32_t amount() {
    good_ = good_ && *at_++ == ' ';
    if (!good_) return 0;
    const bool negative = *at_ == '-';
    if (negative) ++at_;
    const uint32_t size = digits(0x7FFFFFFF, 10);
    return negative ? -static_cast<int32_t>(size) : static_cast<int32_t>(size);
  }

  uint16_t set() { return static_cast<uint16_t>(number(0xFFFF, 16)); }

  // Motions are counted from 1.
  uint32_t sequence() {
    const uint32_t seq = number();
    good_ = good_ && seq > 0;
    return seq;
  }

  // Whether all that was read so far made sense. What comes after it is for later versions to know.
  bool good() const { return good_; }

 private:
  uint32_t digits(uint32_t most, unsigned base) {
    const char* first = at_;
    uint32_t value = 0;
    for (; *at_ && *at_ != ' '; ++at_) {
      const char c = *at_;
      const unsigned digit = c >= '0' && c <= '9'   ? c - '0'
                             : c >= 'A' && c <= 'F' ? c - 'A' + 10
                             : c >= 'a' && c <= 'f' ? c - 'a' + 10
                                                    : 99;
      if (digit >= base || value > (most - digit) / base) {
        good_ = false;
        return 0;
      }
      value = value * base + digit;
    }
    good_ = at_ > first;
    return value;
  }

  const char* at_;
  bool good_ = true;
};

// Microradians, to the nearest.
Decimal micro(double radians) { return Decimal(static_cast<int64_t>(floor(radians * 1e6 + 0.5))); }
}  // namespace

uint16_t crc16(const char* bytes, size_t count) {
  uint16_t crc = 0xFFFF;
  for (size_t k = 0; k < count; ++k) {
    crc ^= static_cast<uint16_t>(static_cast<uint8_t>(bytes[k])) << 8;
    for (int bit = 0; bit < 8; ++bit) crc = crc & 0x8000 ? (crc << 1) ^ 0x1021 : crc << 1;
  }
  return crc;
}

Robot::Robot(Hardware& hardware, const Chassis& chassis, uint32_t boot, float speed)
    : hw_(hardware), chassis_(chassis), boot_(boot),
      patience_(static_cast<float>(kWatchdog) * (speed > 1 ? speed : 1)) {}

void Robot::begin() {
  hw_.drive(0, 0);
  seen_ = switches();
  heard_ = hw_.micros();
  introduce();
}

// A whole port may be read: bits without a switch are 0 on the line.
uint16_t Robot::switches() {
  return static_cast<uint16_t>(hw_.switches() & ((1ul << chassis_.switches) - 1));
}

Robot::Stamp Robot::now() {
  Stamp stamp{hw_.micros(), 0, 0, hw_.heading()};
  hw_.ticks(&stamp.left, &stamp.right);
  return stamp;
}

void Robot::say(const char* body) {
  const size_t count = strlen(body);
  if (count + 6 > kLongestLine) return;  // no such thing is ever said
  char out[kLongestLine + 1];
  // Names come from whoever built the robot: a letter beyond ASCII would spoil the line.
  for (size_t k = 0; k < count; ++k) out[k] = body[k] < 32 || body[k] > 126 ? '?' : body[k];
  const int tail = snprintf(out + count, sizeof out - count, "*%04X\n", crc16(out, count));
  hw_.write(out, count + static_cast<size_t>(tail));
}

void Robot::introduce() {
  char body[160];  // say() leaves out what is too long for a line
  snprintf(body, sizeof body, "h 1 %08lX %08lX %ld %d %.40s", static_cast<unsigned long>(boot_),
           static_cast<unsigned long>(known_ ? session_ : 0),
           lround(patience_ * 1000), chassis_.switches, chassis_.name);
  say(body);
  snprintf(body, sizeof body, "c %ld %ld %ld %ld %ld %ld %ld %ld %ld", static_cast<long>(chassis_.radius),
           static_cast<long>(chassis_.base), static_cast<long>(chassis_.tick_nm),
           static_cast<long>(chassis_.range), static_cast<long>(chassis_.hysteresis),
           static_cast<long>(chassis_.speed), static_cast<long>(chassis_.rate),
           static_cast<long>(chassis_.acceleration), static_cast<long>(chassis_.bumper));
  say(body);
  for (int k = 0; k < chassis_.switches; ++k) {
    snprintf(body, sizeof body, "s %d %ld %.40s", k, static_cast<long>(chassis_.mount[k].angle),
             chassis_.mount[k].name);
    say(body);
  }
}

void Robot::receive(uint8_t b) {
  if (b == kStopByte) {  // whatever else is going on
    length_ = 0;
    spoilt_ = false;
    stop();
  } else if (b == '\n') {
    if (!spoilt_ && length_ > 5) line();
    length_ = 0;
    spoilt_ = false;
  } else if (b == '\r') {
  } else if (b < 32 || b > 126 || length_ + 1 >= kLongestLine) {
    spoilt_ = true;
  } else {
    line_[length_++] = static_cast<char>(b);
  }
}

// A whole line: the body if the checksum holds, and what it asks for.
void Robot::line() {
  line_[length_] = 0;
  char* star = line_ + length_ - 5;
  char sum[6];
  snprintf(sum, sizeof sum, "*%04X", crc16(line_, static_cast<size_t>(star - line_)));
  if (strcmp(star, sum)) return;
  *star = 0;
  if (asked()) heard_ = hw_.micros();
}

// Does what the body in `line_` asks for; whether a host can have said it. Other lines are no sign of one: a
// line that echoes gives the robot back what it said itself, for ever.
bool Robot::asked() {
  Fields fields(line_ + 1);
  switch (line_[0]) {
    case 'H': {
      fields.number();  // the version
      const uint32_t session = fields.number(0xFFFFFFFF, 16);
      if (fields.good()) hello(session);
      return fields.good();
    }
    case 'P': {
      const uint32_t number = fields.number(), event = fields.number();
      if (fields.good()) pinged(number, event);
      return fields.good();
    }
    case 'S': {
      const uint32_t seq = fields.number();
      if (!fields.good()) return false;
      stop();
      answer('a', seq);
      return true;
    }
    case 'M': return motion(kMove);
    case 'T': return motion(kTurn);
    case 'R': return motion(kRest);
    default: return false;
  }
}

// Whether the body in `line_` is a motion of that kind; it is begun then, or refused.
bool Robot::motion(Kind kind) {
  Fields fields(line_ + 1);
  int32_t amount = 0, most = 0;
  uint16_t rise = 0, fall = 0;
  const uint32_t seq = fields.sequence();
  if (kind != kRest) {
    amount = fields.amount();
    most = fields.amount();
    rise = fields.set();
    fall = fields.set();
  }
  const int32_t limit = fields.amount();
  if (!fields.good()) {
    Fields number(line_ + 1);
    const uint32_t refused = number.number();
    if (number.good()) answer('n', refused, " not understood");
    return false;
  }
  command(kind, seq, amount * (kind == kMove ? 1e-5 : 1e-6), most * 1e-3, rise, fall, limit * 1e-3);
  return true;
}

void Robot::answer(char letter, uint32_t number, const char* rest) {
  char body[kLongestLine];
  snprintf(body, sizeof body, "%c %lu%s", letter, static_cast<unsigned long>(number), rest);
  say(body);
}

// The host is there: what it has needs not be said again.
void Robot::pinged(uint32_t number, uint32_t event) {
  int kept = 0;
  for (int k = 0; k < kept_count_; ++k)
    if (kept_[k].number > event) kept_[kept++] = kept_[k];
  kept_count_ = kept;
  answer('p', number);
}

void Robot::hello(uint32_t session) {
  if (!known_ || session != session_) {
    stop();
    known_ = true;
    session_ = session;
    newest_ = events_ = 0;
    kept_count_ = 0;
  }
  introduce();
}

void Robot::command(Kind kind, uint32_t seq, double amount, double most, uint16_t rise, uint16_t fall,
                    double limit) {
  const double fastest = (kind == kMove ? chassis_.speed : chassis_.rate) * 1e-3;
  const char* objection = !known_                                   ? " say hello first"
                          : seq <= newest_                          ? nullptr
                          : kind_ != kNone                          ? " another motion is in hand"
                          : most < 0 || most > fastest * 1.001      ? " faster than this robot can go"
                          : limit <= 0                              ? " without a time limit"
                                                                    : nullptr;
  if (objection) return answer('n', seq, objection);
  if (seq > newest_) {  // else it is a repetition, and only acknowledged
    newest_ = seq_ = seq;
    kind_ = kind;
    amount_ = amount;
    most_ = most;
    limit_ = limit;
    rise_ = rise;
    fall_ = fall;
    speed_ = 0;
    still_ = 0;
    driven_ = 0;
    stopped_ = struck_ = false;
    why_[0] = 0;
    from_ = last_ = now();
  }
  answer('a', seq);
}

// The motion in hand is to end; the first reason counts.
void Robot::end(const char* why) {
  if (kind_ == kNone || why_[0]) return;
  strncpy(why_, why, sizeof why_ - 1);
  why_[sizeof why_ - 1] = 0;
}

// A stop brakes hard, also what is braking already for another reason.
void Robot::stop() {
  stopped_ = true;
  end("stop");
}

void Robot::event(const char* rest, char letter) {
  ++events_;
  char body[kLongestLine];
  snprintf(body, sizeof body, "%c %lu %s", letter, static_cast<unsigned long>(events_), rest);
  if (known_) {
    if (kept_count_ == kKeptEvents) {  // the story has a hole: let it be known as one that begins anew
      kept_count_ = 0;
      ++boot_;
      known_ = false;
      stop();
      introduce();
      return;
    }
    kept_[kept_count_].number = events_;
    memcpy(kept_[kept_count_].body, body, sizeof body);
    ++kept_count_;
    if (kept_count_ == 1) since_said_ = 0;
  }
  say(body);
}

void Robot::poll() {
  const uint16_t is = switches();
  const uint16_t changed = is ^ seen_;
  if (!changed) return;
  const Stamp at = now();
  for (int k = 0; k < chassis_.switches; ++k) {
    const uint16_t bit = static_cast<uint16_t>(1u << k);
    if (!(changed & bit)) continue;
    const bool rising = is & bit;
    char rest[kLongestLine];
    snprintf(rest, sizeof rest, "%d%c %s %ld %ld %s", k, rising ? '+' : '-',
             Decimal(static_cast<int64_t>(at.time)).text(), static_cast<long>(at.left),
             static_cast<long>(at.right), micro(at.heading).text());
    event(rest, 'e');
    if ((rising ? rise_ : fall_) & bit) {
      char why[16];
      snprintf(why, sizeof why, "g%d%c", k, rising ? '+' : '-');
      end(why);
    }
  }
  seen_ = is;
}

void Robot::step() {
  poll();
  if ((hw_.micros() - heard_) * 1e-6 > patience_) end("host");
  control();
  if (++since_report_ >= kReportSteps) {
    since_report_ = 0;
    const Stamp at = now();
    char body[kLongestLine];
    snprintf(body, sizeof body, "r %s %ld %ld %s %02X %d %lu %d",
             Decimal(static_cast<int64_t>(at.time)).text(), static_cast<long>(at.left),
             static_cast<long>(at.right), micro(at.heading).text(), seen_, hw_.bumper() ? 1 : 0,
             static_cast<unsigned long>(events_), hw_.battery_mv());
    say(body);
  }
  if (kept_count_ && ++since_said_ >= kAgainSteps) {
    since_said_ = 0;
    for (int k = 0; k < kept_count_ && k < 8; ++k) say(kept_[k].body);
  }
}

// One control step of the motion in hand: trapezoid in speed, heading held by the gyro.
void Robot::control() {
  if (kind_ == kNone) return;
  const Stamp at = now();
  const double tick = chassis_.tick_nm * 1e-9;
  const double done = kind_ == kMove
                          ? (at.left + at.right - from_.left - from_.right) * tick / 2
                          : at.heading - from_.heading;
  double left = kind_ == kRest ? 0 : amount_ - done;
  if (kind_ == kMove && fabs(left) < tick * 0.55) left = 0;
  const double acceleration = chassis_.acceleration * 1e-3 *
                              (kind_ == kTurn ? 2 / (chassis_.base * 1e-5) : 1);
  if (kind_ == kMove && amount_ > 0 && hw_.bumper()) {
    struck_ = true;
    end("bump");
  }
  const bool stands = at.left == last_.left && at.right == last_.right;
  const double pushes = fmin(0.05, chassis_.speed * 1e-3 / 4);  // so fast the wheels should turn
  const bool still = kind_ == kMove && stands && fabs(speed_) > pushes;
  still_ = still ? still_ + 1 : 0;
  driven_ = still ? driven_ + fabs(speed_) * kStep : 0;
  if (still_ > kStallSteps && driven_ > kStallTicks * tick) {
    struck_ = true;
    end("stall");
  }
  if ((at.time - from_.time) * 1e-6 > limit_) end(kind_ == kRest ? "ok" : "time");
  const double change = acceleration * kStep;
  const bool complete = kind_ != kRest && fabs(left) < 1e-4 && fabs(speed_) <= change;
  if (struck_) {
    speed_ = 0;
  } else if (why_[0]) {
    // A stop brakes twice as hard as the end of a motion.
    const double brake = stopped_ ? 2 * change : change;
    speed_ -= clamp(speed_, -brake, brake);
  } else {
    // The fastest from which equal steps still brake in time: kStep * v now, then v less one step's change,
    // and so on, is what is left. The continuous law would shoot past and come back.
    const double half = kStep / 2;
    double target = acceleration * (sqrt(half * half + 2 * fabs(left) / acceleration) - half);
    if (target > most_) target = most_;
    if (target > fabs(left) / kStep) target = fabs(left) / kStep;
    speed_ = clamp(left < 0 ? -target : target, speed_ - change * 1.5, speed_ + change);
  }
  if (complete && !why_[0]) end("ok");
  if (why_[0] && (fabs(speed_) < 1e-9 || complete || kind_ == kRest)) {
    hw_.drive(0, 0);
    kind_ = kNone;
    char rest[kLongestLine];
    snprintf(rest, sizeof rest, "%lu %s %s %ld %ld %s %02X %d", static_cast<unsigned long>(seq_), why_,
             Decimal(static_cast<int64_t>(at.time)).text(), static_cast<long>(at.left),
             static_cast<long>(at.right), micro(at.heading).text(), seen_, hw_.bumper() ? 1 : 0);
    event(rest, 'd');
    why_[0] = 0;
    return;
  }
  if (kind_ == kMove) {
    const double off = from_.heading - at.heading;
    hw_.drive(static_cast<float>(speed_), static_cast<float>(clamp(off * 0.5 / kStep, -0.5, 0.5)));
  } else {
    hw_.drive(0, kind_ == kTurn ? static_cast<float>(speed_) : 0);
  }
  last_ = at;
}

}  // namespace periplus
