% SPDX-License-Identifier: MIT
% needs: fake --says SSH-2.0-OpenSSH
expect_error('coopdyn:connection', @() coopdyn.connect(), 'not a coopdyn daemon', 'SSH-2.0');
assert(~coopdyn.doctor());
assert(isempty(strfind(evalc('coopdyn.doctor()'), 'names:')));
disp('passed')
