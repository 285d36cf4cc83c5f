# SPDX-License-Identifier: MIT
# Installs the page's libraries: cmake -DPAGE=folder of package-lock.json -DPACKAGES=folder -DNPM=npm -P packages.cmake
file(COPY ${PAGE}/package.json ${PAGE}/package-lock.json DESTINATION ${PACKAGES})
execute_process(
  COMMAND ${NPM} ci --no-audit --no-fund --ignore-scripts --prefer-offline --loglevel=error
  WORKING_DIRECTORY ${PACKAGES}
  OUTPUT_VARIABLE said ERROR_VARIABLE said RESULT_VARIABLE failed)
if(failed)
  message(FATAL_ERROR "The page's libraries cannot be installed (npm ci needs the network the first time):\n${said}")
endif()
file(TOUCH ${PACKAGES}/installed)
