// Deployment files (.pmd), in the grammar of procman's sheriffs.
//
//   file   := { cmd | group | script }        '#' to the end of the line
//   cmd    := "cmd" NAME "{" { IDENT "=" VALUE ";" } "}"
//   group  := "group" NAME "{" { cmd | group } "}"
//   script := "script" NAME "{" { action } "}"
//   action := ("start" | "stop" | "restart") TARGET ["wait" STATUS] ";"
//           | "wait" "ms" INT ";" | "wait" TARGET "status" STATUS ";"
//           | "run_script" NAME ";"
//   TARGET := "everything" | ("cmd" | "group") NAME
//   STATUS := ("running" | "stopped" | "ready") in quotes ["timeout" INT]  (ms)
//
// Stock sheriffs read a file that has none of: working_dir, nice,
// memory_limit_mb, max_processes, depends_on, ready_status, "ready", timeout.
#pragma once

#include "procman/deployment/deployment_types.h"

#include <string>
#include <string_view>

namespace waymark {

// Throws InputError, "source:line:column: what": also where a name is unknown
// or given twice, a script runs itself, or commands depend on each other in a
// circle.
[[nodiscard]] Deployment ParseDeployment(std::string_view text,
                                         const std::string& source);

// Of a file of at most 16 MiB.
[[nodiscard]] Deployment ReadDeployment(const std::string& path);

// `deployment` as a file that ParseDeployment() reads to the same.
[[nodiscard]] std::string DeploymentText(const Deployment& deployment);

}  // namespace waymark
