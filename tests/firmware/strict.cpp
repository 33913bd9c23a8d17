// What the reference firmware answers to lines that a host may have got wrong: each line of the input goes to a
// robot of its own that was greeted before. Prints the acknowledgements, refusals and answers, one line for each.
#include <stdio.h>
#include <string.h>

#include <string>

#include "periplus_robot.hpp"

namespace {
struct Shelf : periplus::Hardware {
  std::string said;

  uint64_t micros() override { return 0; }
  void drive(float, float) override {}
  void ticks(int32_t* left, int32_t* right) override { *left = *right = 0; }
  double heading() override { return 0; }
  uint16_t switches() override { return 0; }
  bool bumper() override { return false; }
  void write(const char* bytes, size_t count) override {
    if (strchr("anp", bytes[0])) said.append(bytes, count - 6).append(";");  // without checksum and end
  }
};

void send(periplus::Robot& robot, const std::string& line) {
  for (char byte : line) robot.receive(static_cast<uint8_t>(byte));
  robot.receive('\n');
}
}  // namespace

int main() {
  char text[256];
  while (fgets(text, sizeof text, stdin)) {
    text[strcspn(text, "\n")] = 0;
    Shelf shelf;
    periplus::Robot robot(shelf, periplus::Chassis(), 1);
    robot.begin();
    send(robot, "H 1 0000002A*6324");
    send(robot, text);
    printf("%s\n", shelf.said.c_str());
  }
}
