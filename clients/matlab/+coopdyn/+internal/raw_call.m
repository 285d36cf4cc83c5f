% SPDX-License-Identifier: MIT
function reply = raw_call(session, name, command, params, data, text, limit)
%RAW_CALL Sends a raw message, by the name of its command or its number.
  session.require_open();
  name = ['/' regexprep(coopdyn.internal.word(name, 'a module, as ''/robot1/motors'','), '^/|/$', '')];
  if ~isnumeric(command)
    command = number_of(session, name, char(command));
  end
  params = double(params);
  if any(params ~= round(params)) || any(abs(params) > 2147483648)
    coopdyn.internal.fail(2, 'params are whole numbers of 32 bits');
  end
  session.forget_readings();
  owner = [];
  for k = 1:numel(session.links)
    link = session.links{k};
    if ~isempty(link.motors) && strcmp(link.motors.module, name)
      owner = link;
    end
  end
  if ~isempty(owner)
    owner.settle(session);
    c = owner.motors;
  else
    c = session.connection(name);
  end
  try
    c.send(command, coopdyn.internal.encode(command, params, data, text));
    message = await_one(session, c, limit);
  catch cause
    coopdyn.internal.recover(session, {c}, {owner}, cause);
  end
  if message.error == 5 && any(strcmp(message.text, {'reset', 'load'}))
    session.new_world(message.text);
  end
  coopdyn.internal.check_reply(message, '');
  session.note(message);
  if any(strcmp(name, {'/simulation', '/playback'}))
    session.reached = 0;  % it may have been a reset
  end
  reply = struct('text', message.text, 'command', message.command, 'params', message.params, ...
                 'data', message.data(1:end - 2), 'time', message.data(end - 1), 'step', message.data(end));
end

function number = number_of(session, name, command)
% From the module's own description, which is queried once.
  entry = {};
  for k = 1:size(session.described, 1)
    if strcmp(session.described{k, 1}, name)
      entry = session.described(k, :);
    end
  end
  if isempty(entry)
    description = coopdyn.internal.describe(session, name);
    commands = description.commands;
    if iscell(commands)
      names = cellfun(@(c) c.name, commands, 'UniformOutput', false);
      ids = cellfun(@(c) c.id, commands);
    else
      names = {commands.name};
      ids = [commands.id];
    end
    entry = {name, names, ids};
    session.described(end + 1, :) = entry;
  end
  at = find(strcmp(entry{2}, command), 1);
  if isempty(at)
    coopdyn.internal.fail(1, [name ' has no command ''' command '''; it has: ' strjoin(reshape(entry{2}, 1, []), ', ')]);
  end
  number = entry{3}(at);
end

function message = await_one(session, c, limit)
% Waits for the reply, which may have to wait for a step.
  wait = coopdyn.internal.Wait(session, limit, ['no answer from ' c.module]);
  message = c.poll(true);
  while isempty(message)
    wait.rest();
    message = c.poll(wait.patient);
  end
end
