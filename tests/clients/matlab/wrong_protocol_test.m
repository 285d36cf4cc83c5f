% SPDX-License-Identifier: MIT
% needs: fake --protocol 2
expect_error('coopdyn:not_possible', @() coopdyn.connect(), 'protocol 2', 'matlab.zip');
disp('passed')
