% SPDX-License-Identifier: MIT
% needs: nothing
% If packets are dropped (here: a listener with a full queue), Octave's own connect would wait for minutes.
command = ['python3 -c "import socket,sys,time; s=socket.socket(); s.bind((''127.0.0.1'',0)); s.listen(0); ' ...
           'c=[socket.socket() for i in range(4)]; [x.setblocking(False) or x.connect_ex(s.getsockname()) for x in c]; ' ...
           'print(s.getsockname()[1],flush=True); sys.stdin.read()"'];
[in, out, pid] = popen2('/bin/sh', {'-c', ['exec ' command]});
line = '';
while isempty(line) || ~ischar(line)
  line = fgetl(out);
  fclear(out);
end
assert(strcmp(coopdyn.internal.probe('127.0.0.1', str2double(line), 0.3), 'silent'));
assert(strcmp(coopdyn.internal.probe('127.0.0.1', 1, 60), 'refused'));
fclose(in);
fclose(out);
waitpid(pid);
disp('passed')
