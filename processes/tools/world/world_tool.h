// waymark-world: pictures, plans and checks of worlds.
#pragma once

namespace waymark {

// The whole tool; returns the exit code.
//
//   waymark-world render WORLD [--pose X,Y,HEADING_DEG] [--camera CAMERA]
//                        [--quality live|still] --out FILE [--depth FILE]
//                        [--surfaces FILE] [--edges FILE] [--seconds T]
//                        [--threads N]
//   waymark-world plan WORLD --out FILE [--seconds T] [--pixels N] [--log LOG]
//   waymark-world info WORLD
//   waymark-world check WORLD... [--threads N]
//
// WORLD and CAMERA are files or names of those that come with Waymark.
[[nodiscard]] int RunWorldTool(int argc, char** argv);

}  // namespace waymark
