% SPDX-License-Identifier: MIT
% needs: nothing
% Invalid servers are errors that say what to write: a port beside the host, the address of the page, a value of another kind.
expect_error('coopdyn:wrong_params', @() coopdyn.connect('127.0.0.1', 21000), 'write coopdyn.connect(''127.0.0.1:21000'')');
expect_error('coopdyn:wrong_params', @() coopdyn.connect("127.0.0.1", 21000, 'watch', true), 'connect(''127.0.0.1:21000'')');
for page = {'http://127.0.0.1:21080/', 'https://labserver'}
  expect_error('coopdyn:out_of_range', @() coopdyn.connect(page{1}), [page{1} ' is the address of the page'], 'HOST:PORT', ...
               'write e.g. coopdyn.connect(''127.0.0.1:10000'')');
end
for server = {{}, {'labserver'}, [1 2], 1.5, NaN, -1, true, struct('a', 1), @sin}
  expect_error('coopdyn:out_of_range', @() coopdyn.connect(server{1}), 'cannot read the server', ...
               'write HOST, HOST:PORT, or a port of this machine');
end
expect_error('coopdyn:out_of_range', @() coopdyn.connect(1.5), 'the server 1.5;');
expect_error('coopdyn:out_of_range', @() coopdyn.connect([1 2]), 'the server [1 2];');
expect_error('coopdyn:out_of_range', @() coopdyn.connect({}), 'the server a 0 x 0 cell;');
expect_error('coopdyn:wrong_data', @() coopdyn.connect('127.0.0.1', 'name', 5), 'a client name has no spaces, not 5');
expect_error('coopdyn:wrong_params', @() coopdyn.connect('127.0.0.1', {}, 5), 'no option a 0 x 0 cell; there are: server');
disp('passed')
