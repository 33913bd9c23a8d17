// The robot's side of the Periplus wire protocol, version 1 (src/wire/PROTOCOL.md), for any board with a
// C++11 compiler: no heap, no exceptions, no library beyond <string.h>, <stdio.h> and <math.h>.
// What is peculiar to a board is behind `Hardware`; see README.md for wiring and porting.
//
// Licensed as Periplus itself: MIT or Apache-2.0, at your option.
#pragma once
#include <stddef.h>
#include <stdint.h>

namespace periplus {

constexpr int kMostSwitches = 16;
constexpr int kLongestLine = 96;  // with its end
constexpr int kKeptEvents = 32;
constexpr uint8_t kStopByte = 0x18;

// The body, in the units of the protocol's `c` and `s` lines.
struct Chassis {
  const char* name = "reference";
  int32_t radius = 10000, base = 16000, tick_nm = 500000;    // 0.01 mm, 0.01 mm, nm
  int32_t range = 6000, hysteresis = 500;                    // 0.01 mm
  int32_t speed = 200, rate = 2000, acceleration = 1000;     // mm/s, mrad/s, mm/s2
  int32_t bumper = 1570796;                                  // microradians to either side
  int switches = 8;
  struct { int32_t angle; const char* name; } mount[kMostSwitches] = {
      {0, "front"},        {785398, "front left"},   {1570796, "left"},  {2356194, "back left"},
      {3141593, "back"},   {-2356194, "back right"}, {-1570796, "right"}, {-785398, "front right"}};
};

// What a board must be able to do. Called from poll() and step() only; none may wait.
struct Hardware {
  virtual ~Hardware() {}
  virtual uint64_t micros() = 0;                         // since the start, does not wrap
  virtual void drive(float speed, float rate) = 0;       // m/s ahead, rad/s counter-clockwise
  virtual void ticks(int32_t* left, int32_t* right) = 0; // since the start, forwards positive, all 32 bits
  virtual double heading() = 0;                          // gyro's integral, rad, not wrapped
  virtual uint16_t switches() = 0;                       // bit k: switch k sees something
  virtual bool bumper() = 0;
  virtual int battery_mv() { return 0; }                 // 0: there is none
  virtual void write(const char* bytes, size_t count) = 0;
};

class Robot {
 public:
  // `boot` must be another number after every start (a counter in EEPROM, or noise); `speed` is 1 but
  // for simulated hardware whose time runs faster than its host's.
  Robot(Hardware& hardware, const Chassis& chassis, uint32_t boot, float speed = 1.0f);

  void begin();             // once, when everything is ready: introduces the robot
  void receive(uint8_t b);  // every byte that comes over the line
  void poll();              // as often as possible, 500 times a second at least: catches the edges
  void step();              // every 20 ms: control, reports, what was not confirmed

 private:
  struct Stamp { uint64_t time; int32_t left, right; double heading; };
  struct Event { uint32_t number; char body[kLongestLine]; };
  enum Kind : uint8_t { kNone, kMove, kTurn, kRest };

  Stamp now();
  uint16_t switches();
  void say(const char* body);
  void introduce();
  void line();
  bool asked();
  bool motion(Kind kind);
  void answer(char letter, uint32_t number, const char* rest = "");
  void pinged(uint32_t number, uint32_t event);
  void hello(uint32_t session);
  void command(Kind kind, uint32_t seq, double amount, double most, uint16_t rise, uint16_t fall,
               double limit);
  void end(const char* why);
  void stop();
  void event(const char* body_after_number, char letter);
  void control();

  Hardware& hw_;
  Chassis chassis_;
  uint32_t boot_;
  float patience_;
  char line_[kLongestLine];
  int length_ = 0;
  bool spoilt_ = false;
  bool known_ = false;
  uint32_t session_ = 0, newest_ = 0, events_ = 0;
  Event kept_[kKeptEvents];
  int kept_count_ = 0, since_said_ = 0, since_report_ = 0;
  uint16_t seen_ = 0;
  uint64_t heard_ = 0;
  Kind kind_ = kNone;
  uint32_t seq_ = 0;
  double amount_ = 0, most_ = 0, limit_ = 0, speed_ = 0;
  uint16_t rise_ = 0, fall_ = 0;
  Stamp from_{}, last_{};
  int still_ = 0;        // steps driven without a tick
  double driven_ = 0;    // and how far, metres
  bool stopped_ = false;  // brakes hard, whatever the reason that is told
  bool struck_ = false;   // the bumper was pressed, or the wheels stalled: stands at once, likewise
  char why_[8] = "";
};

uint16_t crc16(const char* bytes, size_t count);

}  // namespace periplus
