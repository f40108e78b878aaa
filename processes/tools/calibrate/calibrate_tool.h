// waymark-calibrate: a camera from images of a chessboard.
#pragma once

namespace waymark {

// The whole tool; returns the exit code.
//
//   waymark-calibrate IMAGE... --model perspective|fisheye|sphere
//                     --board 8x6 --square 0.042 [--mirrored] [--xi 1]
//                     [--distortion N] [--out camera.yaml] [--json FILE]
//                     [--pictures FOLDER] [--force]
//
// Images without a whole board are named and left out.
[[nodiscard]] int RunCalibrateTool(int argc, char** argv);

}  // namespace waymark
