// lcm-spy draws STATE, MODEL and EFFECTS: a double click on the channel opens its plots of the last minutes.
// `java -cp fathom_types.jar:/usr/share/java/lcm.jar fathom_spy.PlotSpy RUN.lcmlog CHANNEL OUT.png` draws the same from a log.
package fathom_spy;

import fathom_lcm.effects_t;
import fathom_lcm.model_t;
import fathom_lcm.state_t;
import java.awt.BasicStroke;
import java.awt.Color;
import java.awt.Dimension;
import java.awt.Font;
import java.awt.Graphics;
import java.awt.Graphics2D;
import java.awt.RenderingHints;
import java.awt.event.ActionEvent;
import java.awt.geom.Path2D;
import java.awt.image.BufferedImage;
import java.io.EOFException;
import java.io.File;
import java.io.IOException;
import java.lang.reflect.Array;
import java.util.ArrayDeque;
import java.util.ArrayList;
import java.util.LinkedHashMap;
import java.util.List;
import java.util.Locale;
import java.util.Map;
import javax.imageio.ImageIO;
import javax.swing.AbstractAction;
import javax.swing.Action;
import javax.swing.JDesktopPane;
import javax.swing.JFrame;
import javax.swing.JPanel;
import javax.swing.Timer;
import lcm.logging.Log;
import lcm.spy.ChannelData;
import lcm.spy.SpyPlugin;

public class PlotSpy implements SpyPlugin {
  private static final int PERIOD_MS = 100;
  private static final double KEPT_S = 300.0; // of message time
  private static final double SIGMAS = 1.96;  // to each side that hold 95 %
  private static final double DEGREES = 180.0 / Math.PI;
  private static final Color TEXT = new Color(0x1d2b36), SOFT = new Color(0x66757f), LINE = new Color(0xd5dde3);
  private static final Color[] CURVES = {new Color(0x1f6fb2), new Color(0xd2691e), new Color(0x2c8a4b)};

  public boolean canHandle(long fingerprint) {
    return fingerprint == state_t.LCM_FINGERPRINT || fingerprint == model_t.LCM_FINGERPRINT
        || fingerprint == effects_t.LCM_FINGERPRINT;
  }

  public Action getAction(JDesktopPane desktop, final ChannelData channel) {
    return new AbstractAction("Plot") {
      public void actionPerformed(ActionEvent event) {
        new Window(channel);
      }
    };
  }

  /** Shows a channel, as lcm-spy hears it, until it is closed. */
  private static class Window {
    private final ChannelData channel;
    private final Plots plots = new Plots();
    private Object shown;

    Window(ChannelData channel) {
      this.channel = channel;
      JFrame frame = new JFrame(channel.name);
      frame.setDefaultCloseOperation(JFrame.DISPOSE_ON_CLOSE);
      frame.add(plots);
      look();
      frame.pack();
      frame.setLocationByPlatform(true);
      frame.setVisible(true);
      new Timer(PERIOD_MS, event -> {
        if (frame.isDisplayable()) {
          look();
        } else {
          ((Timer) event.getSource()).stop();
        }
      }).start();
    }

    private void look() {
      if (channel.last != null && channel.last != shown) {
        shown = channel.last;
        plots.add(shown);
        plots.repaint();
      }
    }
  }

  /** lcm-spy loads types and plugins each with a loader of its own: its state_t is not ours. Null: no such field. */
  private static Object field(Object message, String name) {
    try {
      return message.getClass().getField(name).get(message);
    } catch (ReflectiveOperationException error) {
      return null;
    }
  }

  private static double number(Object message, String name) {
    Object value = field(message, name);
    return value instanceof Number ? ((Number) value).doubleValue() : Double.NaN;
  }

  private static double[] numbers(Object message, String name) {
    return (double[]) field(message, name);
  }

  private static List<Object> parts(Object message, String name) {
    Object array = field(message, name);
    List<Object> found = new ArrayList<>();
    for (int i = 0; array != null && i < Array.getLength(array); ++i) {
      found.add(Array.get(array, i));
    }
    return found;
  }

  /** One curve: times, values, and half the width of a band about it. */
  private static class Curve {
    final ArrayDeque<double[]> points = new ArrayDeque<>();

    void add(double t, double value, double half) {
      if (!points.isEmpty() && t < points.getLast()[0]) {
        points.clear(); // a log began anew
      }
      points.add(new double[] {t, value, half});
      while (points.getFirst()[0] < t - KEPT_S) {
        points.removeFirst();
      }
    }
  }

  private static class Plots extends JPanel {
    /** By the panel's title and the curve's name. */
    private final Map<String, Map<String, Curve>> panels = new LinkedHashMap<>();
    private String headline = "no message yet";
    private List<Object> candidates = new ArrayList<>();
    private boolean bars;
    private double[] last = {0.0, 0.0, 0.0}; // rad: roll, pitch, yaw

    Plots() {
      setPreferredSize(new Dimension(900, 640));
      setBackground(Color.WHITE);
    }

    private void put(String panel, String curve, double t, double value, double half) {
      panels.computeIfAbsent(panel, title -> new LinkedHashMap<>()).computeIfAbsent(curve, name -> new Curve())
          .add(t, value, half);
    }

    private void put(String panel, String[] names, double t, double[] values, int from, double[] sigma, int sigmaFrom,
        double scale) {
      for (int i = 0; i < names.length; ++i) {
        put(panel, names[i], t, scale * values[from + i], scale * SIGMAS * sigma[sigmaFrom + i]);
      }
    }

    void add(Object message) {
      double t = 1e-6 * number(message, "utime");
      if (field(message, "q_WB") != null) {
        addState(message, t);
      } else if (field(message, "candidates") != null) {
        bars = true;
        candidates = parts(message, "candidates");
        Object against = field(message, "against"), segment = field(message, "segment");
        headline = "verdict: " + field(message, "verdict")
            + ("".equals(against) ? "" : "; not told from: " + against)
            + ("".equals(segment) ? "" : "; would tell: " + segment);
      } else {
        headline = String.format(Locale.ROOT, "%.0f rows used; bands hold 95 %%", number(message, "updates"));
        for (String list : new String[] {"parameters", "effect_numbers"}) {
          for (Object one : parts(message, list)) {
            put(field(one, "name") + " [" + field(one, "unit") + "]", "", t, number(one, "value"),
                SIGMAS * number(one, "std"));
          }
        }
      }
    }

    private void addState(Object message, double t) {
      double[] q = numbers(message, "q_WB"), sigma = numbers(message, "sigma"), nu = numbers(message, "nu");
      double[] euler = {Math.atan2(2 * (q[0] * q[1] + q[2] * q[3]), 1 - 2 * (q[1] * q[1] + q[2] * q[2])),
          Math.asin(Math.max(-1, Math.min(1, 2 * (q[0] * q[2] - q[3] * q[1])))),
          Math.atan2(2 * (q[0] * q[3] + q[1] * q[2]), 1 - 2 * (q[2] * q[2] + q[3] * q[3]))};
      for (int i = 0; i < 3; ++i) { // on from the last one, without a jump at half a turn
        euler[i] += 2 * Math.PI * Math.rint((last[i] - euler[i]) / (2 * Math.PI));
      }
      last = euler;
      headline = Boolean.TRUE.equals(field(message, "valid")) ? "valid; bands hold 95 %" : "NOT VALID yet";
      put("position [m]", new String[] {"N", "E", "D"}, t, numbers(message, "p_WB"), 0, sigma, 0, 1.0);
      put("attitude [deg]", new String[] {"roll", "pitch", "yaw"}, t, euler, 0, sigma, 3, DEGREES);
      put("velocity [m/s]", new String[] {"u", "v", "w"}, t, nu, 0, sigma, 6, 1.0);
      put("rates [deg/s]", new String[] {"p", "q", "r"}, t, nu, 3, sigma, 9, DEGREES);
    }

    @Override
    protected void paintComponent(Graphics graphics) {
      super.paintComponent(graphics);
      draw((Graphics2D) graphics, getWidth(), getHeight());
    }

    void draw(Graphics2D g, int width, int height) {
      g.setRenderingHint(RenderingHints.KEY_ANTIALIASING, RenderingHints.VALUE_ANTIALIAS_ON);
      g.setRenderingHint(RenderingHints.KEY_TEXT_ANTIALIASING, RenderingHints.VALUE_TEXT_ANTIALIAS_ON);
      g.setColor(Color.WHITE);
      g.fillRect(0, 0, width, height);
      g.setFont(new Font(Font.SANS_SERIF, Font.BOLD, 14));
      g.setColor(TEXT);
      g.drawString(headline, 12, 22);
      g.setFont(new Font(Font.SANS_SERIF, Font.PLAIN, 12));
      if (bars) {
        drawBars(g, width);
        return;
      }
      int count = panels.size(), columns = count <= 4 ? Math.min(count, 2) : Math.max(2, width / 280);
      int rows = count == 0 ? 0 : (count + columns - 1) / columns, index = 0;
      for (Map.Entry<String, Map<String, Curve>> panel : panels.entrySet()) {
        int w = width / columns, h = (height - 30) / rows, x = index % columns * w, y = 30 + index / columns * h;
        drawPanel(g, panel.getKey(), panel.getValue(), x + 60, y + 20, w - 74, h - 38);
        ++index;
      }
    }

    private static void drawPanel(Graphics2D g, String title, Map<String, Curve> curves, int x, int y, int w, int h) {
      double first = Double.POSITIVE_INFINITY, last = Double.NEGATIVE_INFINITY, low = first, high = last;
      for (Curve curve : curves.values()) {
        for (double[] p : curve.points) {
          first = Math.min(first, p[0]);
          last = Math.max(last, p[0]);
          if (Double.isFinite(p[1])) {
            low = Math.min(low, p[1]);
            high = Math.max(high, p[1]);
          }
        }
        double[] end = curve.points.getLast(); // the newest band counts: the first one would dwarf all
        if (Double.isFinite(end[1] + end[2])) {
          low = Math.min(low, end[1] - end[2]);
          high = Math.max(high, end[1] + end[2]);
        }
      }
      double margin = Math.max(0.06 * (high - low), 1e-6 + 1e-3 * Math.abs(high));
      low -= margin;
      high += margin;
      g.setColor(LINE);
      g.drawRect(x, y, w, h);
      g.setColor(SOFT);
      for (double level : new double[] {low, 0.5 * (low + high), high}) {
        String text = String.format(Locale.ROOT, "%.3g", level);
        int at = (int) Math.round(y + h * (high - level) / (high - low));
        g.drawString(text, x - 6 - g.getFontMetrics().stringWidth(text), Math.max(y + 10, Math.min(y + h, at + 4)));
      }
      String seconds = String.format(Locale.ROOT, "%.0f s", last - first);
      g.drawString(seconds, x + w - g.getFontMetrics().stringWidth(seconds), y + h + 14);
      g.setColor(TEXT);
      g.drawString(title, x, y - 6);
      int at = x + g.getFontMetrics().stringWidth(title) + 14, colour = 0;
      for (Map.Entry<String, Curve> each : curves.entrySet()) {
        Color own = CURVES[colour++ % CURVES.length];
        Path2D line = new Path2D.Double(), above = new Path2D.Double();
        List<double[]> below = new ArrayList<>();
        for (double[] p : each.getValue().points) {
          if (!Double.isFinite(p[1])) {
            continue;
          }
          double px = x + (last > first ? w * (p[0] - first) / (last - first) : 0.0), per = h / (high - low);
          double half = Double.isFinite(p[2]) ? p[2] : 0.0;
          to(line, px, y + per * (high - p[1]));
          to(above, px, y + per * (high - p[1] - half));
          below.add(new double[] {px, y + per * (high - p[1] + half)});
        }
        if (below.isEmpty()) {
          continue;
        }
        for (int i = below.size() - 1; i >= 0; --i) {
          above.lineTo(below.get(i)[0], below.get(i)[1]);
        }
        above.closePath();
        java.awt.Shape clip = g.getClip();
        g.clipRect(x, y, w, h);
        g.setColor(new Color(own.getRed(), own.getGreen(), own.getBlue(), 40));
        g.fill(above);
        g.setColor(own);
        g.setStroke(new BasicStroke(1.6f));
        g.draw(line);
        g.setStroke(new BasicStroke(1.0f));
        g.setClip(clip);
        double[] end = each.getValue().points.getLast();
        String legend = curves.size() > 1 ? String.format(Locale.ROOT, "%s %.3g", each.getKey(), end[1])
                                          : String.format(Locale.ROOT, "%.3g \u00b1 %.2g", end[1], end[2]);
        g.drawString(legend, at, y - 6);
        at += g.getFontMetrics().stringWidth(legend) + 14;
      }
    }

    private static void to(Path2D path, double x, double y) {
      if (path.getCurrentPoint() == null) {
        path.moveTo(x, y);
      } else {
        path.lineTo(x, y);
      }
    }

    /** Log odds, the likeliest first as they come; a bar to the left is against. */
    private void drawBars(Graphics2D g, int width) {
      double most = 1.0;
      for (Object one : candidates) {
        double odds = number(one, "log_odds");
        most = Double.isFinite(odds) ? Math.max(most, Math.abs(odds)) : most;
      }
      int y = 40, names = 240, numbers = 70, middle = names + (width - names - numbers) / 2;
      double per = (width - names - numbers) / 2.0 / most;
      for (Object one : candidates) {
        double odds = number(one, "log_odds");
        Object variant = field(one, "variant");
        String name = String.valueOf(field(one, "name")).replace('_', ' ');
        g.setColor(TEXT);
        g.drawString("".equals(variant) ? name : name + " (" + variant + ")", 12, y + 14);
        g.setColor(odds > 0 ? CURVES[2] : LINE);
        int length = Double.isFinite(odds) ? (int) Math.round(per * Math.abs(odds)) : 0;
        g.fillRect(odds > 0 ? middle : middle - length, y + 2, length, 16);
        g.setColor(TEXT);
        g.drawString(String.format(Locale.ROOT, "%.3g", odds), width - numbers + 8, y + 14);
        y += 26;
      }
      g.setColor(SOFT);
      g.drawLine(middle, 36, middle, Math.max(y, 60));
      g.drawString("log odds against the model without it; left of the line: against", names, y + 18);
    }
  }

  public static void main(String[] args) throws IOException {
    if (args.length != 3) {
      System.err.println("usage: PlotSpy RUN.lcmlog CHANNEL OUT.png");
      System.exit(2);
    }
    Plots plots = new Plots();
    int count = 0;
    Log log = new Log(args[0], "r");
    try {
      for (Log.Event event = log.readNext();; event = log.readNext()) {
        if (!event.channel.equals(args[1])) {
          continue;
        }
        long fingerprint = java.nio.ByteBuffer.wrap(event.data).getLong();
        if (fingerprint == state_t.LCM_FINGERPRINT) {
          plots.add(new state_t(event.data));
        } else if (fingerprint == model_t.LCM_FINGERPRINT) {
          plots.add(new model_t(event.data));
        } else if (fingerprint == effects_t.LCM_FINGERPRINT) {
          plots.add(new effects_t(event.data));
        } else {
          continue;
        }
        ++count;
      }
    } catch (EOFException end) {
      log.close();
    }
    if (count == 0) {
      System.err.println(args[0] + ": nothing on channel " + args[1] + " that can be drawn (STATE, MODEL, EFFECTS)");
      System.exit(1);
    }
    BufferedImage image = new BufferedImage(900, 640, BufferedImage.TYPE_INT_RGB);
    plots.draw(image.createGraphics(), image.getWidth(), image.getHeight());
    ImageIO.write(image, "png", new File(args[2]));
  }
}
