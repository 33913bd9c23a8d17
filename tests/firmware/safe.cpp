// What the reference firmware does when it must not drive, or not any more: robots on a floor, each told
// something else. Prints a line for each, of what came of it.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <string>

#include "periplus_robot.hpp"

namespace {
// A robot on a floor with one host; its wheels do what they are told, unless they are held.
struct Floor : periplus::Hardware {
  double way = 0, turned = 0, speed = 1, rate = 1;
  bool held = false, pressed = false, hosted = true;
  uint16_t closed = 0;
  uint64_t us = 0;
  uint32_t heard = 0;  // the newest event that the host has
  std::string said;
  periplus::Robot robot;

  explicit Floor(float pace = 1) : robot(*this, periplus::Chassis(), 7, pace) { robot.begin(); }

  uint64_t micros() override { return us; }
  void drive(float ahead, float turning) override { speed = ahead; rate = turning; }
  void ticks(int32_t* left, int32_t* right) override {
    *left = *right = static_cast<int32_t>(floor(way / 0.0005));
  }
  double heading() override { return turned; }
  uint16_t switches() override { return closed; }
  bool bumper() override { return pressed; }
  void write(const char* bytes, size_t count) override { said.append(bytes, count); }

  void bytes(const std::string& all) {
    for (char byte : all) robot.receive(static_cast<uint8_t>(byte));
  }

  static std::string line(const char* body) {
    char sum[8];
    snprintf(sum, sizeof sum, "*%04X\n", periplus::crc16(body, strlen(body)));
    return body + std::string(sum);
  }

  // What it answers to `body`, up to the checksum.
  std::string answer(const char* body) {
    said.clear();
    bytes(line(body));
    return said.substr(0, said.find('*'));
  }

  bool moves() const { return speed != 0 || rate != 0; }
  const char* gait() const { return moves() ? "moves" : "stands"; }

  // Lets so many control steps pass, with its host there if it is.
  void pass(int steps) {
    for (int k = 0; k < steps; ++k) {
      if (hosted) {
        char ping[32];
        snprintf(ping, sizeof ping, "P 1 %u", static_cast<unsigned>(heard));
        bytes(line(ping));
      }
      us += 20000;
      if (!held) way += speed * 0.02;
      turned += rate * 0.02;
      robot.poll();
      robot.step();
    }
  }

  // Steps until it stands, and what it says of the end; nothing is waited for longer than 12 s.
  std::string ending() {
    said.clear();
    int steps = 0;
    while (steps < 600 && (moves() || said.find("\nd ") == std::string::npos)) {
      said.insert(0, "\n");
      pass(1);
      ++steps;
    }
    const size_t at = said.find("\nd ");
    if (at == std::string::npos) return "never";
    char id[16], why[16], told[64];
    sscanf(said.c_str() + at, " d %*u %15s %15s", id, why);
    snprintf(told, sizeof told, "%s %s after %d", id, why, steps);
    return told;
  }

  int count(const char* what) const {
    int found = 0;
    for (size_t at = said.find(what); at != std::string::npos; at = said.find(what, at + 1)) ++found;
    return found;
  }
};

// A robot that a host has said hello to.
struct Known : Floor {
  explicit Known(float pace = 1) : Floor(pace) { answer("H 1 2A"); }
};

// ... and that is under way, at its full speed.
struct Driving : Known {
  explicit Driving(const char* motion = "M 1 400000 200 0 0 10000", float pace = 1) : Known(pace) {
    answer(motion);
    pass(20);
  }
};

void tell(const char* what, const std::string& came) { printf("%s: %s\n", what, came.c_str()); }

void stops() {
  { Floor f; tell("beginning", f.gait()); }
  { Driving f; f.bytes("\x18"); tell("stop byte", f.ending()); }
  { Driving f; const std::string a = f.answer("S 9"); tell("stop line", a + ", " + f.ending()); }
  { Driving f; f.bytes("P 1 \x01\x18"); tell("after a bad line and a stop byte", f.answer("S 9")); }
  { Driving f; f.bytes("P 1\x18"); tell("after half a line and a stop byte", f.answer("S 9")); }
  { Driving f; f.answer("H 1 2B"); tell("another host", f.ending()); }
  {
    Driving f;
    f.hosted = false;
    const std::string came = f.ending();
    f.hosted = true;
    f.pass(50);
    tell("silence", came);
    tell("a host that is back", f.gait());
  }
  {
    Driving f("M 1 400000 200 0 0 10000", 2);
    f.hosted = false;
    tell("silence at twice the pace", f.ending());
  }
  { Known f; f.answer("M 1 400000 200 0 0 1000"); tell("time limit", f.ending()); }
  { Known f; f.answer("R 1 500"); f.pass(5); tell("rest", f.gait()); tell("its end", f.ending()); }
  { Driving f("M 1 400000 200 8 0 10000"); f.closed = 8; tell("guard", f.ending()); }
  {
    Driving f("M 1 400000 200 8 0 10000");
    f.closed = 8;
    f.pass(2);
    f.bytes("\x18");
    tell("guard and stop", f.ending());
  }
  {
    Known f;
    f.closed = 8;
    f.robot.poll();
    f.answer("T 1 6000000 2000 0 8 10000");
    f.pass(20);
    f.closed = 0;
    tell("falling guard", f.ending());
  }
  { Driving f("M 1 400000 200 0 8 10000"); f.closed = 8; f.pass(10); tell("no guard", f.gait()); }
  { Driving f; f.pressed = true; tell("bumper", f.ending()); }
  { Driving f("M 1 -400000 200 0 0 10000"); f.pressed = true; f.pass(10); tell("backing off", f.gait()); }
  { Driving f("M 1 -400000 200 0 0 10000"); f.held = true; tell("held", f.ending()); }
}

void refuses() {
  { Floor f; tell("no hello", f.answer("M 1 1000 200 0 0 10000")); }
  { Driving f; tell("another in hand", f.answer("M 2 -1000 100 0 0 10000")); }
  { Known f; tell("too fast", f.answer("M 1 1000 900 0 0 10000")); }
  { Known f; tell("turning too fast", f.answer("T 1 1000 2500 0 0 10000")); }
  { Known f; tell("backwards in time", f.answer("M 1 1000 -200 0 0 10000")); }
  { Known f; tell("no limit", f.answer("M 1 1000 200 0 0 0")); }
  { Known f; tell("no words", f.answer("M 1 what")); }
  { Known f; f.bytes("M 1 1000 200 0 0 10000*0000\n"); f.pass(3); tell("wrong checksum", f.gait()); }
}

void counts() {
  {
    Known f;
    f.answer("M 1 5000 200 0 0 10000");
    const std::string came = f.ending(), again = f.answer("M 1 5000 200 0 0 10000");
    f.pass(3);
    tell("said once", came);
    tell("said twice", again + ", " + f.gait());
    for (const char* hello : {"H 1 2A", "H 1 2B"}) {
      f.answer(hello);
      const std::string taken = f.answer("M 1 5000 200 0 0 10000");
      f.pass(3);
      tell(hello, taken + ", " + f.gait());
    }
  }
  {
    Known f;
    f.answer("M 1 5000 200 0 0 10000");
    f.ending();
    f.pass(20);
    f.said.clear();
    f.pass(20);
    const bool again = f.count("d 1 1 ok") >= 3;
    f.heard = 1;
    f.pass(1);
    f.said.clear();
    f.pass(20);
    tell("an end", again ? "said again and again" : "said once");
    tell("an end that is known", f.count("d 1 ") ? "said again" : "said no more");
  }
  {
    Known f;
    f.answer("M 1 5000 200 0 0 10000");
    f.ending();
    f.answer("H 1 2B");
    f.said.clear();
    f.pass(20);
    tell("an end of another host's", f.count("d 1 ") ? "said again" : "said no more");
  }
  {
    Driving f;
    f.said.clear();
    for (int k = 0; k <= periplus::kKeptEvents; ++k) { f.closed ^= 1; f.robot.poll(); }
    const bool told = f.count("h 1 00000008 00000000 ") == 1;
    f.said.clear();
    f.pass(10);
    tell("a hole", std::string(told ? "told, " : "untold, ") + f.gait());
    tell("after it", f.answer("M 2 1000 200 0 0 10000"));
  }
  {
    Known f;
    f.answer("M 1 100000 150 0 0 10000");
    double fastest = 0, hardest = 0;
    for (int k = 0; k < 100; ++k) {
      const double before = f.speed;
      f.pass(1);
      fastest = fmax(fastest, f.speed);
      hardest = fmax(hardest, f.speed - before);
    }
    tell("speed", fastest < 0.1501 && hardest < 0.0201 ? "within bounds" : "beyond");
  }
}
}  // namespace

int main() {
  stops();
  refuses();
  counts();
}
