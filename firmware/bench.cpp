// The reference firmware on a bench: its hardware functions simulated in a room of 3 x 2.4 m, behind a
// pseudo-terminal. Prints the path that a host opens:  ./bench [times as fast as life]
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#include "periplus_robot.hpp"

namespace {
struct Wall { double ax, ay, bx, by; };
const Wall kWalls[] = {{0, 0, 3, 0}, {3, 0, 3, 2.4}, {3, 2.4, 0, 2.4}, {0, 2.4, 0, 0}};

// A disc with eight beams between straight walls; time advances by calls of pass().
struct Bench : periplus::Hardware {
  periplus::Chassis chassis;
  int line = -1;
  double x = 1, y = 1, th = 0.35, gyro = 0, lw = 0, rw = 0, v = 0, w = 0;
  uint64_t us = 0;
  uint16_t closed = 0;
  bool pressed = false;

  double clearance(double px, double py) const {
    double least = 1e9;
    for (const Wall& k : kWalls) {
      const double dx = k.bx - k.ax, dy = k.by - k.ay;
      double t = ((px - k.ax) * dx + (py - k.ay) * dy) / (dx * dx + dy * dy);
      t = t < 0 ? 0 : t > 1 ? 1 : t;
      least = fmin(least, hypot(px - k.ax - t * dx, py - k.ay - t * dy));
    }
    return least;
  }

  double beam(double angle) const {
    const double c = cos(angle), s = sin(angle);
    double least = 1e9;
    for (const Wall& k : kWalls) {
      const double dx = k.bx - k.ax, dy = k.by - k.ay, det = c * -dy + s * dx;
      if (fabs(det) < 1e-12) continue;
      const double ex = k.ax - x, ey = k.ay - y;
      const double t = (ex * -dy + ey * dx) / det, u = (c * ey - s * ex) / det;
      if (t > 0 && u >= 0 && u <= 1) least = fmin(least, t);
    }
    return least;
  }

  void pass(double seconds) {
    const double nx = x + v * seconds * cos(th + w * seconds / 2);
    const double ny = y + v * seconds * sin(th + w * seconds / 2);
    const double radius = chassis.radius * 1e-5;
    const bool free = clearance(nx, ny) >= radius || clearance(nx, ny) > clearance(x, y);
    if (free) { x = nx; y = ny; }
    th += w * seconds;
    gyro += w * seconds;
    const double base = chassis.base * 1e-5, tick = chassis.tick_nm * 1e-9;
    lw += ((free ? v : 0) - w * base / 2) * seconds / tick;
    rw += ((free ? v : 0) + w * base / 2) * seconds / tick;
    pressed = !free && v > 0;
    us += static_cast<uint64_t>(llround(seconds * 1e6));
    const double reach = (chassis.radius + chassis.range) * 1e-5, open = chassis.hysteresis * 1e-5;
    for (int k = 0; k < chassis.switches; ++k) {
      const uint16_t bit = static_cast<uint16_t>(1u << k);
      const double d = beam(th + chassis.mount[k].angle * 1e-6);
      if (d <= reach) closed |= bit;
      if (d > reach + open) closed &= static_cast<uint16_t>(~bit);
    }
  }

  uint64_t micros() override { return us; }
  void drive(float speed, float rate) override { v = speed; w = rate; }
  void ticks(int32_t* l, int32_t* r) override { *l = static_cast<int32_t>(floor(lw)); *r = static_cast<int32_t>(floor(rw)); }
  double heading() override { return gyro; }
  uint16_t switches() override { return closed; }
  bool bumper() override { return pressed; }
  void write(const char* bytes, size_t count) override {
    if (::write(line, bytes, count) < 0) { /* nobody listens: it is said again */ }
  }
};

double seconds() {
  timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_nsec) * 1e-9;
}
}  // namespace

int main(int argc, char** argv) {
  const double speed = argc > 1 ? atof(argv[1]) : 1;
  if (!(speed >= 0.1 && speed <= 1000)) { fprintf(stderr, "bench: from 0.1 to 1000 times as fast as life\n"); return 2; }
  const int line = posix_openpt(O_RDWR | O_NOCTTY);
  if (line < 0 || grantpt(line) || unlockpt(line)) { perror("bench: pseudo-terminal"); return 1; }
  const char* path = ptsname(line);
  const int other = open(path, O_RDWR | O_NOCTTY);  // kept open, lest the line hangs up between hosts
  termios raw;
  tcgetattr(other, &raw);
  cfmakeraw(&raw);
  tcsetattr(other, TCSANOW, &raw);
  fcntl(line, F_SETFL, O_NONBLOCK);
  printf("%s\n", path);
  fflush(stdout);

  Bench bench;
  bench.line = line;
  periplus::Robot robot(bench, bench.chassis, static_cast<uint32_t>(getpid()), static_cast<float>(speed));
  robot.begin();
  const double began = seconds();
  double lived = 0;
  for (;;) {
    pollfd ready{line, POLLIN, 0};
    ::poll(&ready, 1, 1);
    uint8_t bytes[512];
    const ssize_t count = read(line, bytes, sizeof bytes);
    for (ssize_t k = 0; k < count; ++k) robot.receive(bytes[k]);
    const double due = (seconds() - began) * speed;
    if (due - lived > speed) lived = due - 0.02;  // the machine slept: the robot did too
    while (lived + 0.02 <= due) {
      for (int k = 0; k < 20; ++k) { bench.pass(0.001); robot.poll(); }
      robot.step();
      lived += 0.02;
    }
  }
}
