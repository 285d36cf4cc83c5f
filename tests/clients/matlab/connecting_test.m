% SPDX-License-Identifier: MIT
% needs: fake --silent
% Connecting times out, and reports cause and cure.
expect_error('coopdyn:timed_out', @() coopdyn.connect('timeout', 0.3), 'does not answer', 'coopdyn status');
expect_error('coopdyn:connection', @() coopdyn.connect('127.0.0.1:1'), 'nothing listens', 'coopdyn serve');
expect_error('coopdyn:out_of_range', @() coopdyn.connect('host:port'), 'HOST:PORT');
expect_error('coopdyn:wrong_params', @() coopdyn.connect('nmae', 'ana'), 'timeout');
assert(~coopdyn.doctor('127.0.0.1:1'));
disp('passed')
