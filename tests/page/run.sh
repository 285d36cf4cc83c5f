#!/bin/sh
# SPDX-License-Identifier: MIT
# Runs the page's tests, all or of some files: COOPDYN_BINARY=build/release/coopdyn tests/page/run.sh [console.test.js ...]
set -eu
cd "$(dirname "$0")"
wanted=$(node -p 'require("./package-lock.json").packages["node_modules/playwright-core"].version')
present=$(node -p 'require("./node_modules/playwright-core/package.json").version' 2>/dev/null || true)
[ "$wanted" = "$present" ] || npm ci --no-audit --no-fund
reporter=tap
[ ! -t 1 ] || reporter=spec
exec node --test-reporter=$reporter run.js "$@"
