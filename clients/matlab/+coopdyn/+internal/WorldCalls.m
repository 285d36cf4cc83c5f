% SPDX-License-Identifier: MIT
classdef WorldCalls < handle
%WORLDCALLS Requests of a simulation to /world: live edits. Part of coopdyn.Simulation.
  properties (Access = protected)
    session
  end
  methods
    function names = insert(sim, sections)
    %INSERT Inserts things, robots, targets and lights: sections of a scenario, or a file of sections. Returns their names, a
    %   cell array. [BOX_*] uses the next free number; a text in one line has | between lines.
      coopdyn.internal.need(nargin, 2, 'sim.insert(''[BOX_*] | type box | size 0.5 0.5 0.5 | position 2 1'')');
      if ~coopdyn.internal.is_text(sections) || isempty(char(sections))
        coopdyn.internal.fail(3, ['sections are a text, not ' coopdyn.internal.show(sections) ': write ' ...
          'sim.insert(''[BOX_*] | type box | size 0.5 0.5 0.5 | position 2 1'')']);
      end
      sections = char(sections);
      if ~any(sections == '[') && isfile(sections)
        sections = fileread(sections);
      end
      names = strsplit(edit(sim, 140, [], sections), ' ');
    end

    function remove(sim, names)
    %REMOVE Removes objects: a name, or a cell array of names.
      coopdyn.internal.need(nargin, 2, 'sim.remove(''BOX_1'')');
      if ~iscell(names)
        names = {names};
      end
      for k = 1:numel(names)
        names{k} = coopdyn.internal.word(names{k}, 'a name');
      end
      edit(sim, 141, [], strjoin(names(:)', ' '));
    end

    function move(sim, name, position, turn)
    %MOVE Moves an object and stops it: position [x y] or [x y z] (m); turn: a yaw (rad), or a quaternion [w x y z], which
    %   needs x, y and z. Omitted components stay unchanged.
      coopdyn.internal.need(nargin, 3, 'sim.move(''BOX_1'', [2 1])');
      if nargin < 4
        turn = [];
      end
      if ~isnumeric(position) || ~any(numel(position) == [2 3])
        coopdyn.internal.fail(3, ['a position is [x y] or [x y z], not ' coopdyn.internal.show(position) ': write ' ...
          'sim.move(''BOX_1'', [2 1])']);
      end
      if ~isnumeric(turn) || ~any(numel(turn) == [0 1 4]) || (~isempty(turn) && numel(position) ~= 3)
        coopdyn.internal.fail(3, ['a turn is a yaw or [w x y z], and needs x, y and z: write ' ...
          'sim.move(''BOX_1'', [2 1 0.25], 1.57)']);
      end
      edit(sim, 142, [position(:)' turn(:)'], coopdyn.internal.word(name, 'a name'));
    end

    function change(sim, name, varargin)
    %CHANGE Changes keys of a thing's section in the scenario: sim.change('BOX_1', 'color', 'red', 'mass', 2).
      if nargin < 4 || mod(numel(varargin), 2) ~= 0 || ~iscellstr(varargin(1:2:end))
        coopdyn.internal.fail(3, 'write a name, then keys and their values: sim.change(''BOX_1'', ''color'', ''red'', ''mass'', 2)');
      end
      text = coopdyn.internal.word(name, 'a name');
      for k = 1:2:numel(varargin)
        value = varargin{k + 1};
        if isnumeric(value)
          value = strtrim(sprintf('%.17g ', value));
        end
        text = [text char(10) varargin{k} ' ' char(value)];  %#ok<AGROW>
      end
      edit(sim, 143, [], text);
    end

    function rename(sim, name, new_name)
    %RENAME Renames a thing, a robot (including its modules) or a light.
      coopdyn.internal.need(nargin, 3, 'sim.rename(''BOX_1'', ''crate'')');
      edit(sim, 144, [], [coopdyn.internal.word(name, 'a name') ' ' coopdyn.internal.word(new_name, 'a name')]);
    end

    function what = undo(sim)
    %UNDO Undoes the last edit, by any client; returns the object concerned.
      what = edit(sim, 147, [], '');
    end

    function what = redo(sim)
    %REDO Redoes the edit that undo or a reset undid last.
      what = edit(sim, 148, [], '');
    end

    function w = world(sim)
    %WORLD All present objects: a struct with things, robots, targets and lights, with ids, names and poses.
      reply = sim.session.tell('/world', 145);
      w = jsondecode(reply.text);
    end

    function file = save_scenario(sim, file)
    %SAVE_SCENARIO Writes the present world, with all poses, as a scenario; returns the file's name.
      coopdyn.internal.need(nargin, 2, 'sim.save_scenario(''mine.scenario'')');
      file = char(file);
      reply = sim.session.tell('/world', 146);
      out = fopen(file, 'w');
      if out < 0
        coopdyn.internal.fail(5, [file ' cannot be written: choose another folder or name']);
      end
      fwrite(out, unicode2native(reply.text, 'UTF-8'));
      fclose(out);
    end

    function p = pick(sim, origin, direction)
    %PICK The first hit of a ray from a point in a direction: a struct with name ('': no hit), point and distance (m).
      coopdyn.internal.need(nargin, 3, 'sim.pick([0 0 5], [0 0 -1])');
      reply = sim.session.tell('/world', 149, [], [origin(:)' direction(:)']);
      p = struct('name', reply.text, 'point', reshape(reply.data(1:3), 1, 3), 'distance', reply.data(4));
    end
  end
  methods (Access = private)
    function names = edit(sim, command, data, text)
      reply = sim.session.tell('/world', command, [], data, text, 60);
      lines = strsplit(reply.text, char(10));
      names = lines{1};
      for k = 2:numel(lines)
        fprintf(2, 'coopdyn: %s\n', lines{k});
      end
    end
  end
end
